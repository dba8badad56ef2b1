// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "reduce/table.hpp"
#include "storage/journal/plan_file.hpp"

#include <cstddef>
#include <functional>
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

/// An estimate with its 95 % confidence interval: bootstrap (percentile method), Wilson for
/// probabilities.
struct Estimate {
    std::string name;
    double value = 0.0, low = 0.0, high = 0.0;
};

/// Weights of `n` observations in one replicate: how often each was drawn.
using Weights = std::vector<double>;

/// Applies `statistic`, which returns the same named values for all weights, to the observations
/// and to `replicates` resamples of them with replacement. Two calls give the same numbers.
std::vector<Estimate> bootstrap(std::size_t n, const std::vector<std::string>& names,
                                const std::function<std::vector<double>(const Weights&)>& statistic,
                                std::size_t replicates = 1000);

/// The values of one column in the blocks of a design (sampling/design.hpp), one row per block;
/// blocks with missing values are omitted.
using Blocks = std::vector<std::vector<double>>;

/// Quantiles, mean and standard deviation of a sample, and the probabilities that it exceeds the
/// thresholds: "mean", "sd", "q05", "q25", "q50", "q75", "q95", then one per threshold.
std::vector<Estimate> distribution_of(std::vector<double> values,
                                      const std::vector<double>& thresholds);

/// First-order and total Sobol indices of each key: two estimates per key. First order: estimator
/// of Janon et al. (2014); total: Jansen (1999). A column without variance has no indices.
std::vector<Estimate> sobol_indices(const Blocks& blocks, std::size_t keys);

/// Morris measures per key: mean mu of the elementary effects, mean mu_star of their magnitudes and
/// standard deviation sigma. `points` contains the points of each block in the unit cube, so
/// that an effect is the change of the column over the whole range of a key.
std::vector<Estimate> morris_measures(const Blocks& blocks,
                                      const std::vector<std::vector<std::vector<double>>>& points,
                                      std::size_t keys);

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
