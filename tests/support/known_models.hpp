// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace shearwake::test {

/// First-order and total index of a key.
struct KnownIndex {
    double first_order = 0.0, total = 0.0;
};

/// The function of Ishigami and Homma (1990) with a = 7 and b = 0.1 on the unit cube; further
/// coordinates have no effect.
inline double ishigami(const std::vector<double>& u) {
    const auto x = [&](std::size_t i) { return std::numbers::pi * (2.0 * u[i] - 1.0); };
    return std::sin(x(0)) + 7.0 * std::pow(std::sin(x(1)), 2) +
           0.1 * std::pow(x(2), 4) * std::sin(x(0));
}

inline double ishigami_variance() {
    const double pi = std::numbers::pi;
    return 0.5 * std::pow(1.0 + 0.1 * std::pow(pi, 4) / 5.0, 2) + 49.0 / 8.0 +
           0.01 * std::pow(pi, 8) * (1.0 / 18.0 - 1.0 / 50.0);
}

/// Of the three coordinates.
inline std::vector<KnownIndex> ishigami_indices() {
    const double pi = std::numbers::pi, v = ishigami_variance();
    const double v1 = 0.5 * std::pow(1.0 + 0.1 * std::pow(pi, 4) / 5.0, 2), v2 = 49.0 / 8.0,
                 v13 = 0.01 * std::pow(pi, 8) * (1.0 / 18.0 - 1.0 / 50.0);
    return {{v1 / v, (v1 + v13) / v}, {v2 / v, v2 / v}, {0.0, v13 / v}};
}

/// The weights a of the g-function of Sobol.
inline const std::vector<double> g_weights = {0.0, 1.0, 4.5, 9.0};

inline double g_function(const std::vector<double>& u) {
    double product = 1.0;
    for (std::size_t i = 0; i < g_weights.size(); ++i)
        product *= (std::abs(4.0 * u[i] - 2.0) + g_weights[i]) / (1.0 + g_weights[i]);
    return product;
}

inline std::vector<KnownIndex> g_indices() {
    std::vector<double> parts;
    double variance = 1.0;
    for (const double a : g_weights) {
        parts.push_back(1.0 / (3.0 * (1.0 + a) * (1.0 + a)));
        variance *= 1.0 + parts.back();
    }
    variance -= 1.0;
    std::vector<KnownIndex> indices;
    for (const double part : parts)
        indices.push_back({part / variance, part * (variance + 1.0) / (1.0 + part) / variance});
    return indices;
}

} // namespace shearwake::test
