// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sampling/points.hpp"

#include <optional>

namespace shearwake::sampling {

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
