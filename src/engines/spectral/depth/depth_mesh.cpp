// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/depth/depth_mesh.hpp"

#include "base/error.hpp"
#include "base/units.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace shearwake::spectral {

double DepthMesh::z_m(std::size_t level) const {
    const auto d = static_cast<std::size_t>(degree);
    const std::size_t element = std::min(level / d, elements() - 1);
    const double x = rule.nodes[std::min(level - element * d, d)];
    return ends_m[element] + 0.5 * (1.0 + x) * length_m(element);
}

namespace {

/// Limits on element lengths that follow from the accuracy: for the first element in units of the
/// shortest useful length, and for all elements in wavelengths of their layer.
struct Longest {
    double first = 2.0, all = std::numeric_limits<double>::infinity();
};

/// Measured for a footprint of 3 mm at 7 m/s. Without losses, switching on the load sends short
/// waves downward: the relative error of the field is 1.2e-3 at 2, 2.6e-4 at 1 and 3e-5 at 0.65. A
/// viscosity of 0.5 Pa s (omega viscosity / mu = 0.2 where the spectrum is 1e-2) damps these waves:
/// 3e-5 at 2.
Longest longest_elements(const Case& c, const SpectralOptions& options) {
    if (options.time_step_s) return {}; // the job specifies the step
    double least_loss = std::numeric_limits<double>::infinity();
    for (const Layer& layer : c.scene.medium.layers) {
        const double k = bandwidth_rad_m(c.scene.load.footprint, 1e-2);
        least_loss = std::min(least_loss, newtonian_viscosity_Pa_s(layer.loss).value_or(0.0) * k /
                                              (layer.density_kg_m3 * layer.c_s_m_s));
    }
    if (least_loss > 0.1) return {.first = options.accuracy >= 4e-4 ? 2.0 : 1.0};
    const double most = options.accuracy >= 4e-3 ? 2.0 : options.accuracy >= 4e-4 ? 1.0 : 0.65;
    return {most, most};
}

/// Tissue of 100 mm needs about ten elements, a map of bones about a hundred.
constexpr std::size_t most_elements = 4000;

UsageError too_fine(const Case& c, double h_m) {
    double depth_m = 0.0;
    for (const Layer& layer : c.scene.medium.layers)
        depth_m += layer.thickness_m;
    return UsageError(
        fmt::format("solver.spectral: layers of {:.4g} mm in total need more than {} elements over "
                    "the depth, some of them only {:.2g} mm long; use thinner layers, a higher "
                    "c_s, a wider focus, a slower load or a larger longest_element_mm",
                    1e3 * depth_m, most_elements, 1e3 * h_m),
        ExitCode::bad_job);
}

} // namespace

std::vector<double> DepthMesh::clear_levels_m() const {
    std::vector<double> levels_m;
    for (std::size_t level = 0; level < clear_levels(); ++level)
        levels_m.push_back(z_m(level));
    return levels_m;
}

std::size_t DepthMesh::clear_levels() const {
    std::size_t clear = elements();
    // Tolerance for rounding errors.
    while (clear > 1 && ends_m[clear] > clear_depth_m() * (1.0 + 1e-9))
        --clear;
    return clear * static_cast<std::size_t>(degree) + 1;
}

DepthMesh choose_mesh(const Case& c, const SpectralOptions& options, double step_s) {
    const int degree = options.degree;
    DepthMesh mesh{.degree = degree,
                   .rule = gauss_lobatto(degree),
                   .ends_m = {0.0},
                   .layers = {},
                   .light = {},
                   .bottom = {}};
    const double per_degree = degree / 8.0;
    const double steepest = bandwidth_rad_m(c.scene.load.footprint, 1e-3);
    const double omega = bandwidth_rad_m(c.scene.load.footprint, 1e-2) *
                             greatest_speed_m_s(c.scene.load.modulation.trajectory) +
                         two_pi * greatest_envelope_frequency_Hz(c.scene.load.modulation.envelope);
    // a_mu = 1/12 is stable for omega dt < 2.42 with omega = c_s sqrt(finest) (2/h).
    const double calm_m = 2.0 * c.scene.medium.layers.front().c_s_m_s *
                          std::sqrt(finest_mode(mesh.rule)) * step_s / 2.42;
    const double short_m = 9.0 * per_degree / steepest;
    const Longest longest = longest_elements(c, options);
    // Below a load that moves faster than the waves, the waves are shorter than the load. Measured
    // at 7/5.
    const double top_speed_m_s =
        std::max(c.scene.medium.layers.front().c_s_m_s,
                 greatest_speed_m_s(c.scene.load.modulation.trajectory) / 1.4);
    double next_m =
        std::clamp(calm_m, std::min(1.0, longest.first) * short_m, longest.first * short_m);
    const auto fill = [&](std::size_t layer, double thickness_m, double longest_m) {
        const double cap = options.longest_element_m > 0.0
                               ? std::min(longest_m, options.longest_element_m)
                               : longest_m;
        double left_m = thickness_m;
        while (left_m > 1e-12 * thickness_m) {
            double h = std::min(std::min(next_m, cap), left_m);
            // Avoid a thin element at the interface by splitting the remaining length evenly.
            if (left_m < 1.6 * h) h = left_m < 1.05 * h ? left_m : 0.5 * left_m;
            if (mesh.layers.size() == most_elements) throw too_fine(c, h);
            mesh.ends_m.push_back(mesh.ends_m.back() + h);
            mesh.layers.push_back(layer);
            left_m -= h;
            next_m = std::max(next_m, 1.5 * h);
        }
    };
    double depth_m = 0.0;
    for (const Layer& layer : c.scene.medium.layers)
        depth_m += layer.thickness_m;
    if (c.scene.medium.base == Base::half_space) {
        mesh.bottom = absorbing_bottom(c, options);
        depth_m += mesh.bottom->clear_m;
    }
    for (const MeshPiece& piece : mesh_pieces(c, depth_m, 0.02 * short_m, degree, omega)) {
        const double c_s_m_s = c.scene.medium.layers[piece.layer].c_s_m_s;
        fill(piece.layer, piece.bottom_m - piece.top_m,
             std::min({piece.longest_m, 20.0 * per_degree * c_s_m_s / std::max(omega, 1.0),
                       longest.all * short_m * c_s_m_s / top_speed_m_s}));
        mesh.light.resize(mesh.elements(), piece.has_light_body);
    }
    if (mesh.bottom)
        fill(c.scene.medium.layers.size() - 1, mesh.bottom->depth_m, mesh.bottom->depth_m);
    mesh.light.resize(mesh.elements(), false);
    return mesh;
}

double finest_mode(const GaussLobatto& rule) {
    const std::size_t n = rule.nodes.size();
    std::vector<double> x(n), y(n);
    for (std::size_t i = 0; i < n; ++i)
        x[i] = i % 2 ? 1.0 : -1.0;
    double largest = 0.0;
    for (int iteration = 0; iteration < 1000; ++iteration) { // power iteration
        std::fill(y.begin(), y.end(), 0.0);
        for (std::size_t q = 0; q < n; ++q) {
            double slope = 0.0;
            for (std::size_t j = 0; j < n; ++j)
                slope += rule.derivative[q * n + j] * x[j];
            for (std::size_t i = 0; i < n; ++i)
                y[i] += rule.weights[q] * slope * rule.derivative[q * n + i];
        }
        double norm = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            y[i] /= rule.weights[i];
            norm = std::max(norm, std::abs(y[i]));
        }
        largest = norm;
        for (std::size_t i = 0; i < n; ++i)
            x[i] = y[i] / norm;
    }
    return largest;
}

namespace {

/// Legendre polynomials of degrees n and n - 1 at x.
struct Legendre {
    double p, before;
};

Legendre legendre(int n, double x) {
    if (n == 0) return {1.0, 0.0};
    double before = 1.0, p = x;
    for (int j = 2; j <= n; ++j) {
        const double next = ((2.0 * j - 1.0) * x * p - (j - 1.0) * before) / j;
        before = p;
        p = next;
    }
    return {p, before};
}

} // namespace

GaussLobatto gauss_lobatto(int degree) {
    const auto count = static_cast<std::size_t>(degree) + 1;
    GaussLobatto rule{std::vector<double>(count), std::vector<double>(count),
                      std::vector<double>(count * count, 0.0)};
    for (std::size_t i = 0; i < count; ++i) {
        // Zeros of (1 - x^2) P'_n by Newton's method, starting from the Chebyshev points: (1 - x^2)
        // P'_n = n (P_{n-1} - x P_n) has the derivative -n (n + 1) P_n.
        double x = -std::cos(std::numbers::pi * static_cast<double>(i) / degree);
        for (int step = 0; step < 50; ++step) {
            const Legendre l = legendre(degree, x);
            const double change = (l.before - x * l.p) / ((degree + 1.0) * l.p);
            x += change;
            if (std::abs(change) < 1e-16) break;
        }
        if (i == 0) x = -1.0;
        if (i + 1 == count) x = 1.0;
        rule.nodes[i] = x;
        rule.weights[i] = 2.0 / (degree * (degree + 1.0) * std::pow(legendre(degree, x).p, 2));
    }
    for (std::size_t i = 0; i < count; ++i) {
        double diagonal = 0.0; // each row sums to zero, as the derivative of a constant is zero
        for (std::size_t j = 0; j < count; ++j) {
            if (i == j) continue;
            const double d = legendre(degree, rule.nodes[i]).p / legendre(degree, rule.nodes[j]).p /
                             (rule.nodes[i] - rule.nodes[j]);
            rule.derivative[i * count + j] = d;
            diagonal -= d;
        }
        rule.derivative[i * count + i] = diagonal;
    }
    return rule;
}

std::vector<double> interpolation_weights(const GaussLobatto& rule, double x) {
    std::vector<double> weights(rule.nodes.size(), 1.0);
    for (std::size_t i = 0; i < weights.size(); ++i)
        for (std::size_t j = 0; j < weights.size(); ++j)
            if (i != j) weights[i] *= (x - rule.nodes[j]) / (rule.nodes[i] - rule.nodes[j]);
    return weights;
}

std::vector<double> smoothing_weights(const GaussLobatto& rule, double x) {
    const std::size_t nodes = rule.nodes.size();
    const int degrees = static_cast<int>(std::max<std::size_t>(nodes, 3)) - 2;
    std::vector<double> weights(nodes, 0.0);
    for (std::size_t j = 0; j < nodes; ++j)
        for (int n = 0; n < degrees; ++n)
            weights[j] +=
                legendre(n, x).p * rule.weights[j] * legendre(n, rule.nodes[j]).p * (n + 0.5);
    return weights;
}

DepthWeights depth_weights(const DepthMesh& mesh, double depth_m) {
    if (depth_m > mesh.ends_m.back() * (1.0 + 1e-9)) // inside the base
        return {static_cast<std::ptrdiff_t>(mesh.levels()) - 1, {1.0}};
    const auto above = std::upper_bound(mesh.ends_m.begin() + 1, mesh.ends_m.end() - 1, depth_m);
    const auto e = static_cast<std::size_t>(above - mesh.ends_m.begin()) - 1;
    return {static_cast<std::ptrdiff_t>(e) * mesh.degree,
            interpolation_weights(mesh.rule,
                                  2.0 * (depth_m - mesh.ends_m[e]) / mesh.length_m(e) - 1.0)};
}

} // namespace shearwake::spectral
