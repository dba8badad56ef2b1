#pragma once

#include <vector>

namespace shearwake {

/// Gauss-Lobatto-Legendre rule of a degree: degree + 1 nodes on [-1, 1], the ends among them, exact
/// for polynomials up to 2 degree - 1; and the derivative of the interpolating polynomial,
/// f'(x_i) = sum_j derivative[i (degree + 1) + j] f(x_j).
struct GaussLobatto {
    std::vector<double> nodes;
    std::vector<double> weights;
    std::vector<double> derivative;
};

/// degree >= 1.
GaussLobatto gauss_lobatto(int degree);

/// Weights of the nodes' values at x in [-1, 1], of the interpolating polynomial (Lagrange).
std::vector<double> interpolation_weights(const GaussLobatto& rule, double x);
/// The same of its projection onto polynomials two degrees lower,
/// sum over n of P_n(x) w_j P_n(x_j) (n + 1/2), Legendre's.
std::vector<double> smoothing_weights(const GaussLobatto& rule, double x);

} // namespace shearwake
