// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace shearwake::reduce {

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

} // namespace shearwake::reduce
