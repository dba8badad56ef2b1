// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "base/vectors.hpp"
#include "problem/case/case.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace shearwake {

/// A warning or an error about a case. `key` is the job key to change.
struct Remark {
    Severity severity = Severity::warning;
    std::string key;
    std::string message;
    bool operator==(const Remark&) const = default;
};

/// The motion of some points of the surface, uniformly sampled from t = 0.
struct PointMotion {
    std::vector<Vec2> at_m;
    double rate_Hz = 0.0;
    std::vector<std::vector<double>> u_m; // one row per point, positive into the skin
    std::optional<double> radius_m;       // radius of the pins, if known
};

/// The stress at some receptors, uniformly sampled from t = 0.
struct PointStress {
    double rate_Hz = 0.0;
    std::vector<std::vector<double>> compression_Pa; // one row per receptor
};

/// An axis of a sweep whose points are chosen by the results.
struct AdaptiveAxis {
    enum class Goal { refine, maximum, minimum, crossing };
    std::string key;
    Goal goal = Goal::refine;
    double first = 0.0, last = 0.0; // in the unit of the key
    std::string column;
    double tolerance = 0.0; // refine: in the unit of the column; otherwise: in that of the key
    /// refine: points are not closer than this, in the unit of the key.
    double smallest_step = 0.0;
    bool has_level = false; // crossing: of a level; otherwise of the value of the reference
    double level = 0.0;
    std::size_t initial = 9; // number of points of the first round, including both ends
    std::size_t most = 200;  // largest number of points
    bool operator==(const AdaptiveAxis&) const = default;

    bool is_extremum() const { return goal == Goal::maximum || goal == Goal::minimum; }
};

/// The name of a goal in a job: "refine", "maximum", "minimum" or "crossing".
constexpr const char* name_of(AdaptiveAxis::Goal goal) {
    constexpr const char* names[] = {"refine", "maximum", "minimum", "crossing"};
    return names[static_cast<std::size_t>(goal)];
}

/// A swept key as written in the job file ("load.modulation.am_frequency_Hz", in the unit of the
/// job) and its value in this case. Words and flags are text.
struct Setting {
    std::string key;
    std::variant<double, std::string> value;
    bool operator==(const Setting&) const = default;
};

/// "key = value, ...".
std::string settings_text(const std::vector<Setting>& settings);

/// A case with its place in the sweep.
struct PlannedCase {
    std::string id; // case_id(physics)
    Case physics;
    std::vector<Setting> settings; // one per swept key of this case, in the order of the job
    bool is_reference = false;     // the unmodulated case in addition to the sweep
    std::string reference_id; // id of the case that it is compared with; empty if there is none
    std::optional<std::size_t> sample = std::nullopt; // row of the design of [uncertain]
    bool operator==(const PlannedCase&) const = default;
};

/// Layout of the results: rows and curves.
struct TableOptions {
    std::string x;                   // swept key of the horizontal axis; empty: none
    std::vector<std::string> series; // swept keys, one curve per combination of their values
    bool operator==(const TableOptions&) const = default;
};

/// A threshold of [uncertain]: the probability that a column of the table exceeds it is estimated.
struct Threshold {
    std::string column;
    double value = 0.0;
    bool operator==(const Threshold&) const = default;
};

/// [uncertain]: the keys that are sampled together and the design of the sample. Cases with equal
/// values of the other swept keys form a sample; PlannedCase::sample is their row in the design.
struct UncertainPlan {
    std::vector<std::string> keys;
    std::string sampling; // "sobol", "latin-hypercube" or "random"
    std::string analysis; // "distribution", "sobol-indices" or "morris"
    std::size_t samples = 0;
    std::uint64_t seed = 0;
    std::vector<Threshold> exceedance;
    bool operator==(const UncertainPlan&) const = default;
};

/// An expanded job, the content of `plan.json`.
struct Plan {
    std::string name;
    std::string title;
    std::string answer; // the column that answers the question of the job; empty: not given
    std::vector<std::string> swept_keys; // in the order of the job
    TableOptions table;
    std::vector<PlannedCase> cases; // in the order of the job, references last
    std::optional<UncertainPlan> uncertain = std::nullopt;
    std::vector<AdaptiveAxis> adaptive = {}; // in the order of the job
    bool operator==(const Plan&) const = default;
};

/// Pointers to all cases of the plan, in its order.
inline std::vector<const PlannedCase*> cases_of(const Plan& plan) {
    std::vector<const PlannedCase*> cases;
    for (const PlannedCase& planned : plan.cases)
        cases.push_back(&planned);
    return cases;
}

} // namespace shearwake
