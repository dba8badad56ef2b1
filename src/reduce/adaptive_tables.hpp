// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "reduce/table.hpp"
#include "storage/journal/plan_file.hpp"

#include <string>
#include <vector>

namespace shearwake::reduce {

/// The state of an adaptive axis according to the complete cases.
struct AdaptiveState {
    AdaptiveAxis axis;
    std::vector<double> points; // of the plan, ascending, in the unit of the key
    std::vector<double> next;   // to be added; empty: the axis is finished
    /// One sentence per location, or one with the estimated error.
    std::vector<std::string> sentences;
};

/// The states of all adaptive axes, and a table with one row per interval of a refined curve and
/// per location: key, goal, column, the other settings as text, from, to, location, value,
/// estimated_error, and within_tolerance (yes or no).
struct AdaptiveStates {
    std::vector<AdaptiveState> axes;
    Table table;
};

/// Evaluates the table of a plan with adaptive axes, whose rows are its cases in order. Cases with
/// the same values of the other swept keys form a curve. If several axes search the same extremum
/// of the same column, they search it together. Cases without a result and cases whose readings are
/// not valid have no value.
AdaptiveStates adaptive_states(const storage::PlanIndex& plan, const Table& table);

} // namespace shearwake::reduce
