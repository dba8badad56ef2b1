// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/depth/gauss_lobatto.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake::spectral {
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
    const int kept = static_cast<int>(std::max<std::size_t>(nodes, 3)) - 2;
    std::vector<double> weights(nodes, 0.0);
    for (std::size_t j = 0; j < nodes; ++j)
        for (int n = 0; n < kept; ++n)
            weights[j] +=
                legendre(n, x).p * rule.weights[j] * legendre(n, rule.nodes[j]).p * (n + 0.5);
    return weights;
}

} // namespace shearwake::spectral
