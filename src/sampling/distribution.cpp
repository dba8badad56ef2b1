// SPDX-License-Identifier: BSD-3-Clause
#include "sampling/distribution.hpp"

#include "base/field.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/lognormal.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/triangular.hpp>
#include <boost/math/distributions/uniform.hpp>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace shearwake::sampling {

namespace {

/// A truncation that leaves less of a distribution is considered a typing error; beyond it the
/// probabilities have too few digits.
constexpr double least_mass = 1e-6;

auto library_form(const Uniform& u) {
    return boost::math::uniform_distribution<double>(u.min, u.max);
}
auto library_form(const Normal& n) {
    return boost::math::normal_distribution<double>(n.mean, n.sd);
}
auto library_form(const LogNormal& n) {
    return boost::math::lognormal_distribution<double>(std::log(n.median),
                                                       std::log(n.geometric_sd));
}
auto library_form(const Triangular& t) {
    return boost::math::triangular_distribution<double>(t.min, t.mode, t.max);
}

double untruncated_below(const Empirical& e, double x) {
    const auto& v = e.values;
    if (x <= v.front()) return x < v.front() ? 0.0 : 0.5 / static_cast<double>(v.size());
    if (x >= v.back()) return 1.0;
    const auto above = std::upper_bound(v.begin(), v.end(), x);
    const double i = static_cast<double>(above - v.begin() - 1);
    return (i + (x - *(above - 1)) / (*above - *(above - 1))) / static_cast<double>(v.size() - 1);
}
double untruncated_below(const LogNormal& n, double x) {
    return x <= 0.0 ? 0.0 : std::isinf(x) ? 1.0 : boost::math::cdf(library_form(n), x);
}
template <class Shape>
double untruncated_below(const Shape& shape, double x) {
    if (std::isinf(x)) return x > 0.0 ? 1.0 : 0.0;
    return boost::math::cdf(library_form(shape), x);
}

double untruncated_quantile(const Empirical& e, double p) {
    const double place = p * static_cast<double>(e.values.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(place), e.values.size() - 2);
    const double share = place - static_cast<double>(i);
    return e.values[i] * (1.0 - share) + e.values[i + 1] * share;
}
template <class Shape>
double untruncated_quantile(const Shape& shape, double p) {
    return boost::math::quantile(library_form(shape), p);
}

double below(const Distribution& d, double x) {
    return std::visit([&](const auto& shape) { return untruncated_below(shape, x); }, d.shape);
}

struct Ends {
    double lower, upper;
};

Ends truncated(const Distribution& d) {
    return {std::isinf(d.least) ? 0.0 : below(d, d.least),
            std::isinf(d.most) ? 1.0 : below(d, d.most)};
}

std::string problem_of_shape(const Distribution& d) {
    return std::visit(
        overloaded{
            [](const Uniform& u) {
                return u.min < u.max ? std::string()
                                     : fmt::format("requires min < max, but min is {} and max {}",
                                                   u.min, u.max);
            },
            [](const Normal& n) {
                return n.sd > 0.0 ? std::string()
                                  : fmt::format("requires an sd above 0, but it is {}", n.sd);
            },
            [](const LogNormal& n) {
                return n.median > 0.0 && n.geometric_sd > 1.0
                           ? std::string()
                           : fmt::format("requires a median above 0 and a geometric_sd above 1, "
                                         "but they are {} and {}",
                                         n.median, n.geometric_sd);
            },
            [](const Triangular& t) {
                return t.min <= t.mode && t.mode <= t.max && t.min < t.max
                           ? std::string()
                           : fmt::format("requires min <= mode <= max and min < max, but they are "
                                         "{}, {} and {}",
                                         t.min, t.mode, t.max);
            },
            [](const Empirical& e) {
                return e.values.size() >= 2 && e.values.front() < e.values.back()
                           ? std::string()
                           : std::string("requires at least two different values");
            },
        },
        d.shape);
}

} // namespace

std::optional<std::string> problem_of(const Distribution& d) {
    if (std::string problem = problem_of_shape(d); !problem.empty()) return problem;
    const Ends ends = truncated(d);
    if (!(ends.upper - ends.lower >= least_mass))
        return fmt::format("is truncated to nothing: the interval from {} to {} has the "
                           "probability {:.3g}; at least {:g} is required",
                           d.least, d.most, std::max(0.0, ends.upper - ends.lower), least_mass);
    if (d.root_of > 0.0 && std::max(d.least, quantile({d.shape, d.least, d.most}, 1e-9)) < 0.0)
        return "allows negative moduli; truncate it with min";
    return std::nullopt;
}

double quantile(const Distribution& d, double p) {
    const Ends ends = truncated(d);
    const double untruncated = std::clamp(ends.lower + p * (ends.upper - ends.lower), 1e-300,
                                          1.0 - std::numeric_limits<double>::epsilon() / 2.0);
    const double x = std::clamp(
        std::visit([&](const auto& shape) { return untruncated_quantile(shape, untruncated); },
                   d.shape),
        d.least, d.most);
    return d.root_of > 0.0 ? std::sqrt(d.root_of * x) : x;
}

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
