// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Dense>

namespace shearwake::optimise {

/// The quadratic forms of an envelope e, given by its values at the knots: the maximised measure is
/// eta = e' N e / e' D e, and the strength of the focus is (e' F e / 1' F 1)^1/2, where 1 is the
/// unmodulated load. All matrices are symmetric and positive semidefinite, in m^2. For the
/// reconstruction efficiency N and F are the same matrix.
struct Forms {
    Eigen::MatrixXd numerator, denominator, focal;
    Eigen::Index knots() const { return numerator.rows(); }
};

/// A ratio of two quadratic forms, and its gradient in the values at the knots.
double eta(const Forms& forms, const Eigen::VectorXd& envelope);
Eigen::VectorXd eta_gradient(const Forms& forms, const Eigen::VectorXd& envelope);

/// e' F e / 1' F 1, the square of the strength, and its gradient.
double squared_strength(const Forms& forms, const Eigen::VectorXd& envelope);
Eigen::VectorXd squared_strength_gradient(const Forms& forms, const Eigen::VectorXd& envelope);

} // namespace shearwake::optimise
