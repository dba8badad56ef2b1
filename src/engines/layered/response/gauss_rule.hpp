// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <utility>
#include <vector>

namespace shearwake::layered {

/// Nodes in (-1, 1) and weights of Gauss-Legendre quadrature, exact for polynomials up to degree
/// 2 order - 1. Not collective.
std::vector<std::pair<double, double>> gauss_nodes(int order);

/// The rule of this order, exact up to degree 31.
struct GaussRule {
    static constexpr int order = 16;
    std::array<double, order> node{}, weight{};
};
/// The rule, computed once. Not collective.
const GaussRule& gauss_rule();

} // namespace shearwake::layered
