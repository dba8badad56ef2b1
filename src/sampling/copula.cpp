// SPDX-License-Identifier: BSD-3-Clause
#include "sampling/copula.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <numbers>

namespace shearwake::sampling {
namespace {

/// A pivot below this means that a number is determined by the others.
constexpr double least_pivot = 1e-6;

Eigen::MatrixXd lower_factor(const std::vector<std::vector<double>>& correlations, bool& exists) {
    const auto n = static_cast<Eigen::Index>(correlations.size());
    Eigen::MatrixXd matrix(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j)
            matrix(i, j) = correlations[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    const Eigen::LLT<Eigen::MatrixXd> factors(matrix);
    const Eigen::MatrixXd lower = factors.matrixL();
    exists = factors.info() == Eigen::Success && lower.diagonal().minCoeff() > least_pivot;
    return lower;
}

} // namespace

Copula::Copula(std::size_t dimensions)
    : correlations_(dimensions, std::vector<double>(dimensions, 0.0)) {
    for (std::size_t i = 0; i < dimensions; ++i)
        correlations_[i][i] = 1.0;
}

void Copula::correlate(std::size_t i, std::size_t j, double rank) {
    const double normal = 2.0 * std::sin(std::numbers::pi * rank / 6.0);
    correlations_[i][j] = correlations_[j][i] = normal;
}

bool Copula::exists() const {
    bool exists = true;
    if (!correlations_.empty()) lower_factor(correlations_, exists);
    return exists;
}

void Copula::apply(Points& points) const {
    bool exists = true;
    const Eigen::MatrixXd lower = lower_factor(correlations_, exists);
    const boost::math::normal_distribution<double> normal;
    const auto n = static_cast<Eigen::Index>(correlations_.size());
    for (std::vector<double>& point : points) {
        Eigen::VectorXd z(n);
        for (Eigen::Index i = 0; i < n; ++i)
            z(i) = boost::math::quantile(normal, point[static_cast<std::size_t>(i)]);
        const Eigen::VectorXd correlated = lower * z;
        for (Eigen::Index i = 0; i < n; ++i)
            point[static_cast<std::size_t>(i)] =
                std::clamp(boost::math::cdf(normal, correlated(i)), 1e-16, 1.0 - 1e-16);
    }
}

} // namespace shearwake::sampling
