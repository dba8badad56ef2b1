// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sampling/design.hpp"

#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace shearwake::sampling {

struct Uniform {
    double min = 0.0, max = 1.0;
};
struct Normal {
    double mean = 0.0, sd = 1.0;
};
/// exp(N): the logarithm is normal with the mean log(median) and the standard deviation
/// log(geometric_sd).
struct LogNormal {
    double median = 1.0, geometric_sd = 2.0;
};
struct Triangular {
    double min = 0.0, mode = 0.5, max = 1.0;
};
/// Observed values in ascending order; quantiles are interpolated linearly between them.
struct Empirical {
    std::vector<double> values;
};

/// A distribution of a number, truncated to [least, most]. With `root_of` the number is the square
/// root of root_of times the truncated number, as a shear-wave speed sqrt(mu / rho).
struct Distribution {
    std::variant<Uniform, Normal, LogNormal, Triangular, Empirical> shape;
    double least = -std::numeric_limits<double>::infinity();
    double most = std::numeric_limits<double>::infinity();
    double root_of = 0.0; // 0: the number itself
};

/// What makes a distribution unusable, as a sentence that follows its name; nothing if it is
/// usable.
std::optional<std::string> problem_of(const Distribution& distribution);

/// The value that is not exceeded with the probability `p` in (0, 1), of a usable distribution.
double quantile(const Distribution& distribution, double p);

/// A Gaussian copula: uniform numbers with given rank correlations (Spearman). The correlation of
/// the normal numbers behind them is 2 sin(pi rank / 6).
class Copula {
public:
    explicit Copula(std::size_t dimensions);

    /// Sets the rank correlation of two dimensions, between -1 and 1.
    void correlate(std::size_t i, std::size_t j, double rank);
    /// Whether such numbers exist: the matrix of correlations is positive definite.
    bool exists() const;
    /// Gives independent uniform numbers the correlations. Row i depends on point i only.
    void apply(Points& points) const;

private:
    std::vector<std::vector<double>> correlations_;
};

} // namespace shearwake::sampling
