// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

namespace shearwake::layered {

/// Gauss-Legendre quadrature on (-1, 1), exact for polynomials up to degree 31.
struct GaussRule {
    static constexpr int order = 16;
    std::array<double, order> node{}, weight{};
};
/// The rule, computed once. Not collective.
const GaussRule& gauss_rule();

} // namespace shearwake::layered
