// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/gauss_rule.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace shearwake::layered {
namespace {

/// Newton's method on the Legendre polynomial.
GaussRule make_gauss_rule() {
    constexpr int order = GaussRule::order;
    GaussRule rule;
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
        rule.node[static_cast<std::size_t>(i)] = x;
        rule.weight[static_cast<std::size_t>(i)] = 2.0 / ((1.0 - x * x) * slope * slope);
    }
    return rule;
}

} // namespace

const GaussRule& gauss_rule() {
    static const GaussRule rule = make_gauss_rule();
    return rule;
}

} // namespace shearwake::layered
