// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/gauss_rule.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace shearwake::layered {

/// Newton's method on the Legendre polynomial.
std::vector<std::pair<double, double>> gauss_nodes(int order) {
    std::vector<std::pair<double, double>> nodes;
    for (int i = 0; i < order; ++i) {
        double x = std::cos(std::numbers::pi * (i + 0.75) / (order + 0.5)), slope = 1.0;
        for (int step = 0; step < 100; ++step) {
            double p = 1.0, before = 0.0;
            for (int n = 1; n <= order; ++n) {
                const double next = ((2 * n - 1) * x * p - (n - 1) * before) / n;
                before = p;
                p = next;
            }
            slope = order * (x * p - before) / (x * x - 1.0);
            const double change = p / slope;
            x -= change;
            if (std::abs(change) < 1e-16) break;
        }
        nodes.emplace_back(x, 2.0 / ((1.0 - x * x) * slope * slope));
    }
    return nodes;
}

const GaussRule& gauss_rule() {
    static const GaussRule rule = [] {
        GaussRule made;
        const auto nodes = gauss_nodes(GaussRule::order);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            made.node[i] = nodes[i].first;
            made.weight[i] = nodes[i].second;
        }
        return made;
    }();
    return rule;
}

} // namespace shearwake::layered
