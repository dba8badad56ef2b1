// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Dense>
#include <optional>

namespace shearwake::optimise {

/// The quadratic forms of an envelope e, given by its values at the knots: the maximised measure is
/// eta = e' N e / e' D e, and the strength of the focus is (e' F e / S)^1/2, where S = 1' F 1 is
/// the form of the mean of u^2 over the focal disc for the unmodulated load on the path of the job.
/// All matrices are symmetric and positive semidefinite, in m^2.
struct Forms {
    Eigen::MatrixXd numerator, denominator, focal;
    std::optional<double> reference = std::nullopt; // S, if the path is not that of the job

    Eigen::Index knots() const { return numerator.rows(); }
    double reference_energy() const { return reference ? *reference : focal.sum(); }
};

/// A ratio of two quadratic forms, and its gradient in the values at the knots.
double eta(const Forms& forms, const Eigen::VectorXd& envelope);
Eigen::VectorXd eta_gradient(const Forms& forms, const Eigen::VectorXd& envelope);

/// e' F e / S, the square of the strength, and its gradient.
double squared_strength(const Forms& forms, const Eigen::VectorXd& envelope);
Eigen::VectorXd squared_strength_gradient(const Forms& forms, const Eigen::VectorXd& envelope);

} // namespace shearwake::optimise
