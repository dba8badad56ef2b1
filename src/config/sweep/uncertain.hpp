// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/reader.hpp"
#include "config/files/loaders.hpp"
#include "config/sweep/sweep_axes.hpp"
#include "problem/case/plan.hpp"
#include "sampling/distribution.hpp"

#include <optional>
#include <string>
#include <vector>

namespace shearwake::config {

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
