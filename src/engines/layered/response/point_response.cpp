// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/point_response.hpp"

#include "base/units.hpp"
#include "engines/layered/response/gauss_rule.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace shearwake::layered {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr double growth = 7.0;         // largest Im(k) reach
constexpr int exponent = 16;           // of the low-pass filter
constexpr double end_of_pass = 1.2573; // k / k0 at which it is 1e-17
constexpr int gradings = 16;           // halvings of the panels towards k = 0

/// k0 of the low-pass filter: exp(-(pi / (spacing k0))^16) = 1e-10.
double pass_rad_m(double spacing_m) {
    return pi / (spacing_m * std::pow(10.0 * std::numbers::ln10, 1.0 / exponent));
}

} // namespace

Complex low_pass(Complex k_rad_m, double spacing_m) {
    Complex power = k_rad_m / pass_rad_m(spacing_m);
    for (int n = 1; n < exponent; n *= 2)
        power *= power;
    return std::exp(-power);
}

double end_of_pass_rad_m(double spacing_m) {
    return end_of_pass * pass_rad_m(spacing_m);
}

double remainder_from_rad_m(double spacing_m) {
    return pass_rad_m(spacing_m) * std::pow(1e-14, 1.0 / exponent);
}

PointRule point_rule(double spacing_m, double reach_m) {
    const GaussRule& gauss = gauss_rule();
    const double height = growth / reach_m, width = 2.5 * height;
    const double end = end_of_pass_rad_m(spacing_m);
    std::vector<double> edges = {0.0};
    for (int n = gradings; n > 0; --n)
        edges.push_back(std::ldexp(width, -n));
    const auto panels = static_cast<int>(std::ceil(end / width));
    for (int n = 1; n <= panels; ++n)
        edges.push_back(n * width);
    PointRule rule;
    for (std::size_t panel = 0; panel + 1 < edges.size(); ++panel)
        for (std::size_t i = 0; i < GaussRule::order; ++i) {
            const double half = 0.5 * (edges[panel + 1] - edges[panel]);
            const double s = edges[panel] + half * (1.0 + gauss.node[i]);
            // k(s) = s + i height s / (s + height)
            const Complex k(s, height * s / (s + height));
            const Complex slope(1.0, std::pow(height / (s + height), 2));
            rule.k_rad_m.push_back(k);
            rule.weight.push_back(low_pass(k, spacing_m) * k * slope *
                                  (gauss.weight[i] * half / two_pi));
        }
    return rule;
}

PointResponse::PointResponse(const PointRule& rule, double spacing_m, double reach_m)
    : weight_(rule.weight),
      bessel_(rule.k_rad_m, spacing_m / radii_per_spacing, table_radii(spacing_m, reach_m)) {}

PointResponse::PointResponse(double spacing_m, double reach_m)
    : PointResponse(point_rule(spacing_m, reach_m), spacing_m, reach_m) {}

std::size_t table_radii(double spacing_m, double reach_m) {
    const double step_m = spacing_m / radii_per_spacing;
    return static_cast<std::size_t>(std::ceil(reach_m / step_m)) + interpolated;
}

std::size_t radial_blocks(double spacing_m, double reach_m) {
    return (table_radii(spacing_m, reach_m) + radii_together - 1) / radii_together;
}

std::vector<Complex> PointResponse::tables(std::span<const Complex> h, std::size_t columns,
                                           const std::function<bool()>& block_done) {
    using Matrix = BesselBlocks<Complex>::Matrix;
    const auto nodes = std::ssize(weight_);
    Matrix weighted(nodes, static_cast<Eigen::Index>(columns));
    for (Eigen::Index c = 0; c < weighted.cols(); ++c)
        for (Eigen::Index i = 0; i < nodes; ++i)
            weighted(i, c) =
                h[static_cast<std::size_t>(c * nodes + i)] * weight_[static_cast<std::size_t>(i)];
    std::vector<Complex> tables(columns * radii());
    bessel_.multiply(weighted, [&](std::size_t first, const Matrix& part) {
        for (Eigen::Index c = 0; c < part.cols(); ++c)
            std::ranges::copy(part.col(c), tables.begin() +
                                               c * static_cast<std::ptrdiff_t>(radii()) +
                                               static_cast<std::ptrdiff_t>(first));
        return !block_done || block_done();
    });
    return tables;
}

PlaneSampling::PlaneSampling(std::ptrdiff_t half_nx, std::ptrdiff_t half_ny) {
    // Lagrange's weights on equidistant points, the middle of which surrounds the radius.
    std::array<double, interpolated> scale{};
    for (int i = 0; i < interpolated; ++i) {
        double product = 1.0;
        for (int j = 0; j < interpolated; ++j)
            if (j != i) product *= i - j;
        scale[static_cast<std::size_t>(i)] = 1.0 / product;
    }
    for (std::ptrdiff_t i = 0; i <= half_nx; ++i)
        for (std::ptrdiff_t j = 0; j <= half_ny; ++j) {
            const double radius =
                radii_per_spacing * std::hypot(static_cast<double>(i), static_cast<double>(j));
            const auto first =
                static_cast<std::ptrdiff_t>(std::floor(radius)) - interpolated / 2 + 1;
            const double x = radius - static_cast<double>(first);
            first_.push_back(first);
            for (int a = 0; a < interpolated; ++a) {
                double weight = scale[static_cast<std::size_t>(a)];
                for (int b = 0; b < interpolated; ++b)
                    if (b != a) weight *= x - b;
                weights_.push_back(weight);
            }
        }
}

void PlaneSampling::sample(std::span<const Complex> table, Complex* out) const {
    const double* weight = weights_.data();
    for (const std::ptrdiff_t first : first_) {
        Complex sum = 0.0;
        if (first >= 0)
            for (int a = 0; a < interpolated; ++a)
                sum += *weight++ * table[static_cast<std::size_t>(first + a)];
        else // g is even
            for (int a = 0; a < interpolated; ++a)
                sum += *weight++ * table[static_cast<std::size_t>(std::abs(first + a))];
        *out++ = sum;
    }
}

} // namespace shearwake::layered
