// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/loss_tables.hpp"

#include "base/units.hpp"
#include "engines/layered/response/gauss_rule.hpp"
#include "engines/layered/response/point_response.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::layered {
namespace {

using Complex = std::complex<double>;
constexpr std::size_t order = GaussRule::order;
/// Phase of J0(k r) over a panel at the largest radius. Interpolation from the 16 nodes of the
/// panel then has an error of 3e-8.
constexpr double phase_of_panel = 8.75;
/// Share of the largest k^2 L that a panel of L may contribute in error.
constexpr double negligible_share = 1e-11;

/// The weights with which values at the nodes of a panel give the polynomial at x.
std::array<double, order> lagrange(double x) {
    const auto& node = gauss_rule().node;
    std::array<double, order> weights{};
    for (std::size_t j = 0; j < order; ++j) {
        double product = 1.0;
        for (std::size_t m = 0; m < order; ++m)
            if (m != j) product *= (x - node[m]) / (node[j] - node[m]);
        weights[j] = product;
    }
    return weights;
}

} // namespace

RadialInterpolant fit_loss(const StackResponse& response, double spacing_m, double tolerance) {
    const double end = end_of_pass_rad_m(spacing_m);
    double largest = 0.0;
    for (double k = end; k > 1e-4 * end; k /= 1.3)
        largest = std::max(largest, k * k * std::abs(response.loss(k)));
    return RadialInterpolant::fit(
        [&](double k, std::span<Complex> out) { out[0] = response.loss(k); }, 1, end, tolerance,
        negligible_share * largest);
}

FixedPanels::FixedPanels(double spacing_m, double reach_m)
    : spacing_m_(spacing_m), end_rad_m_(end_of_pass_rad_m(spacing_m)),
      count_(static_cast<std::size_t>(std::ceil(end_rad_m_ * reach_m / phase_of_panel))) {}

std::vector<double> FixedPanels::nodes_rad_m() const {
    std::vector<double> nodes;
    for (std::size_t n = 0; n < count_ * order; ++n)
        nodes.push_back(width() * (static_cast<double>(n / order) +
                                   0.5 * (1.0 + gauss_rule().node[n % order])));
    return nodes;
}

std::vector<Complex> FixedPanels::project(const RadialInterpolant& loss) const {
    std::vector<double> edges = loss.edges();
    for (std::size_t panel = 0; panel <= count_; ++panel)
        edges.push_back(width() * static_cast<double>(panel));
    std::ranges::sort(edges);
    std::vector<Complex> sums(count_ * order), values(order);
    std::vector<double> k(order);
    const GaussRule& gauss = gauss_rule();
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
        const double half = 0.5 * (edges[i + 1] - edges[i]), middle = edges[i] + half;
        if (half <= 0.0 || middle >= end_rad_m_) continue;
        for (std::size_t g = 0; g < order; ++g)
            k[order - 1 - g] = middle + half * gauss.node[g]; // the nodes descend
        loss.evaluate(0, k, values.data(), 1);
        const auto panel = std::min(static_cast<std::size_t>(middle / width()), count_ - 1);
        for (std::size_t g = 0; g < order; ++g) {
            const double at = k[order - 1 - g];
            const Complex value = values[order - 1 - g] * gauss.weight[g] * half * at *
                                  low_pass(at, spacing_m_).real() / two_pi;
            const auto shares = lagrange(2.0 * (at / width() - static_cast<double>(panel)) - 1.0);
            for (std::size_t j = 0; j < order; ++j)
                sums[panel * order + j] += value * shares[j];
        }
    }
    return sums;
}

LossResponse::LossResponse(double spacing_m, double reach_m)
    : panels_(spacing_m, reach_m), bessel_(panels_.nodes_rad_m(), spacing_m / radii_per_spacing,
                                           table_radii(spacing_m, reach_m)) {}

std::vector<Complex> LossResponse::tables(std::span<const RadialInterpolant> losses,
                                          const std::function<bool()>& block_done) {
    using Matrix = BesselBlocks<double>::Matrix;
    const auto nodes = std::ssize(bessel_.k_rad_m()), columns = std::ssize(losses);
    Matrix weights(nodes, 2 * columns); // real and imaginary parts
    for (Eigen::Index c = 0; c < columns; ++c) {
        const auto projected = panels_.project(losses[static_cast<std::size_t>(c)]);
        for (Eigen::Index i = 0; i < nodes; ++i) {
            weights(i, 2 * c) = projected[static_cast<std::size_t>(i)].real();
            weights(i, 2 * c + 1) = projected[static_cast<std::size_t>(i)].imag();
        }
    }
    const std::size_t radii = bessel_.radii();
    std::vector<Complex> tables(losses.size() * radii);
    bessel_.multiply(weights, [&](std::size_t first, const Matrix& part) {
        for (Eigen::Index c = 0; c < columns; ++c)
            for (Eigen::Index r = 0; r < part.rows(); ++r)
                tables[static_cast<std::size_t>(c) * radii + first + static_cast<std::size_t>(r)] =
                    {part(r, 2 * c), part(r, 2 * c + 1)};
        return !block_done || block_done();
    });
    return tables;
}

} // namespace shearwake::layered
