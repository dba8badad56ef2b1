// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/reader.hpp"
#include "config/document/tree.hpp"
#include "config/files/files.hpp"
#include "problem/case/plan.hpp"
#include "sampling/distribution.hpp"

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::config {

inline constexpr std::string_view kind_key = "load.modulation.kind";

/// Limit of the number of cases and of the values on an axis; more are considered a typing error.
constexpr std::size_t most_cases = 10000;

/// { linspace = [...] }, { logspace = [...] } or { range = [...] }.
bool is_generator(const Node& node);

/// The values of an axis: a list or a generator. If it is neither, is empty, or contains a value
/// twice, reports errors and returns no values. `key` is for messages.
std::vector<NodePtr> axis_values(const std::string& key, const NodePtr& node,
                                 DiagnosticList& diagnostics);

/// The points of adaptive axes by their keys, ascending, in the unit of the key.
using AxisPoints = std::map<std::string, std::vector<double>>;

/// Whether a value of [sweep] is { refine = [...], ... } or { find = "...", ... }.
bool is_adaptive(const Node& node);

/// Reads an adaptive axis; nothing after an error.
std::optional<AdaptiveAxis> read_adaptive_axis(const std::string& key, const NodePtr& node,
                                               DiagnosticList& diagnostics);

/// A key that takes several values.
struct SweptKey {
    std::string key; // as written in the job
    Path path;
    Place at;
    std::vector<NodePtr> values;
};

/// Keys that change together: value i of each at the same time.
struct Axis {
    std::vector<SweptKey> keys;
    std::size_t size() const { return keys.front().values.size(); }
};

/// A combination of values that is excluded.
struct Exclusion {
    Place at;
    std::vector<std::pair<std::string, NodePtr>> values; // of swept keys
};

/// [sweep]: all combinations of the axes, with the first axis slowest.
struct Sweep {
    Place at;
    bool sound = true; // no error was found
    std::vector<Axis> axes;
    std::vector<Exclusion> exclusions;
    std::vector<AdaptiveAxis> adaptive = {};
    std::optional<std::size_t> sampled_axis = std::nullopt; // the axis of [uncertain]
    // Whether the file sweeps the kind of modulation, even if an override replaces the sweep. Keys
    // of other kinds are then ignored.
    bool varies_kind = false;

    std::vector<std::string> keys() const; // in the order of the job
    bool contains(std::string_view key) const;
};

/// `table` with one entry per full key, in the order of the file: tables are joined with dots down
/// to those that `is_leaf` accepts.
NodePtr flattened(const NodePtr& table,
                  const std::function<bool(const std::string& key, const Node&)>& is_leaf);

/// The path of a full key of a case in the table `where` of a job; nothing after an error.
std::optional<Path> case_path(const Entry& entry, std::string_view where,
                              DiagnosticList& diagnostics);

/// [sweep] with one entry per swept key, independent of how its dots were written: `"a.b" = [1]`,
/// `a.b = [1]` and `[sweep.a]` with `b = [1]` give the same result.
NodePtr flattened_sweep(const NodePtr& sweep);

/// Reports axes that contain a combination of values twice, and a sweep with too many cases.
void check_sweep(Sweep& sweep, DiagnosticList& diagnostics);

/// Reads a flattened [sweep], except its entry `list`. Adaptive axes have the values `points`, or
/// those of the first round if these do not have the key.
Sweep read_sweep(const NodePtr& sweep, const AxisPoints& points, DiagnosticList& diagnostics);

/// Returns all cases of the sweep, with the first axis slowest, followed by the references. `base`
/// is the complete job as a tree; `reference` contains the keys of load.modulation that define a
/// reference, or is null. Also checks the physics of all cases. After an error in [sweep], only the
/// first case is read.
std::vector<PlannedCase> expand(const NodePtr& base, const Sweep& sweep, const NodePtr& reference,
                                const FileLoaders& files, DiagnosticList& diagnostics);

/// Adds the axis of `[sweep] list = "cases.csv"` to the sweep: the first line of the file names
/// full keys, and every further line gives their values in one case. Without this entry nothing
/// changes.
void add_listed_cases(const NodePtr& sweep_node, Sweep& sweep, const FileLoaders& files,
                      DiagnosticList& diagnostics);

/// Reads the distribution of the key `key`, in the unit of the key. Nothing after an error.
std::optional<sampling::Distribution> read_distribution(Reader reader, const std::string& key,
                                                        const FileLoaders& files);

/// The names of the published distributions.
std::vector<std::string> distribution_preset_names();

/// [uncertain] with one entry per key, as flattened_sweep().
NodePtr flattened_uncertain(const NodePtr& uncertain);

/// Reads a flattened [uncertain] and adds its sample to the sweep as the last axis. Nothing after
/// an error.
std::optional<UncertainPlan> read_uncertain(const NodePtr& uncertain, Sweep& sweep,
                                            const FileLoaders& files, DiagnosticList& diagnostics);

/// A key of [uncertain] with its distribution, in the unit of the key.
struct UncertainKey {
    std::string key;
    sampling::Distribution distribution;
};

/// The keys of the flattened [uncertain] of a job, without its sample; empty without this table.
std::vector<UncertainKey> uncertain_keys(const NodePtr& job, const FileLoaders& files,
                                         DiagnosticList& diagnostics);

} // namespace shearwake::config
