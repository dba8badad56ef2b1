// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace shearwake::reduce {

/// An estimate with its 95 % bootstrap confidence interval (percentile method).
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

} // namespace shearwake::reduce
