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

} // namespace shearwake
