// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "reduce/table.hpp"
#include "storage/journal/plan_file.hpp"

#include <string>
#include <vector>

namespace shearwake::reduce {

/// The tables of a job with [uncertain]. One row per combination of the swept values, column and
/// statistic: `value` with its 95 % interval `low_95` to `high_95`, `samples` (number of values),
/// `without_value` (failed, missing or not valid ones) and `note` (a warning if the sample is too
/// small).
struct UncertainTables {
    Table statistics;  // mean, sd, quantiles and exceedance probabilities
    Table sensitivity; // Sobol indices or Morris measures; no rows for other designs
};

/// Evaluates the table of a plan with [uncertain], whose rows are its cases in order, for the
/// columns `columns` and those with a threshold. Throws UsageError if a column with a threshold
/// does not exist.
UncertainTables uncertain_tables(const storage::PlanIndex& plan, const Table& table,
                                 std::vector<std::string> columns);

} // namespace shearwake::reduce
