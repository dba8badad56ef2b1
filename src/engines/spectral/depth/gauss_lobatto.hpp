// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace shearwake::spectral {

/// Gauss-Lobatto-Legendre rule with degree + 1 nodes on [-1, 1] including both ends, exact for
/// polynomials up to degree 2 degree - 1, and the derivative of the interpolating polynomial,
/// f'(x_i) = sum_j derivative[i (degree + 1) + j] f(x_j).
struct GaussLobatto {
    std::vector<double> nodes;
    std::vector<double> weights;
    std::vector<double> derivative;
};

/// The rule of a degree >= 1.
GaussLobatto gauss_lobatto(int degree);

/// Weights of the nodal values for the interpolating polynomial (Lagrange) at x in [-1, 1].
std::vector<double> interpolation_weights(const GaussLobatto& rule, double x);
/// Weights of the nodal values for the L2 projection of the interpolating polynomial onto
/// polynomials of two degrees less: sum over n of P_n(x) w_j P_n(x_j) (n + 1/2) with Legendre
/// polynomials P_n.
std::vector<double> smoothing_weights(const GaussLobatto& rule, double x);

} // namespace shearwake::spectral
