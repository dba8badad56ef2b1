// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

namespace shearwake::optimise {

/// The quadratic forms of an envelope e, given by its values at the knots: the maximised measure is
/// eta = e' N e / e' D e, and the strength of the focus is (e' F e / S)^1/2, where S = 1' F 1 is
/// the form of the mean of u^2 over the focal disc for the unmodulated load on the path of the job.
/// All matrices are symmetric and positive semidefinite, in m^2.
/// `path`: for each point of the drawn path (samples_along_path()), the form of the mean of u^2
/// over time; empty if the uniformity is not constrained.
struct Forms {
    Eigen::MatrixXd numerator, denominator, focal;
    std::optional<double> reference = std::nullopt; // S, if the path is not that of the job
    std::vector<Eigen::MatrixXd> path = {};

    Eigen::Index knots() const { return numerator.rows(); }
    double reference_energy() const { return reference ? *reference : focal.sum(); }
};

/// A ratio of two quadratic forms, and its gradient in the values at the knots.
double eta(const Forms& forms, const Eigen::VectorXd& envelope);
Eigen::VectorXd eta_gradient(const Forms& forms, const Eigen::VectorXd& envelope);

/// e' F e / S, the square of the strength, and its gradient.
double squared_strength(const Forms& forms, const Eigen::VectorXd& envelope);
Eigen::VectorXd squared_strength_gradient(const Forms& forms, const Eigen::VectorXd& envelope);

/// The root of the form of each point of the path.
Eigen::VectorXd rms_along_path(const Forms& forms, const Eigen::VectorXd& envelope);
/// The smallest of these values divided by their mean, from 0 to 1; NaN if all are zero, and
/// without points.
double uniformity(const Eigen::VectorXd& rms);

/// A column of the table that is a quotient of two quadratic forms of the displacement.
struct Quotient {
    enum class Kind {
        efficiency, // eta_period_1
        sharpness,  // sharpness_1
        share,      // share_{low}_{high}_1, of the trace at trace_m()
        velocity_share
    };
    Kind kind = Kind::efficiency;
    FrequencyBand band; // of a share
};

/// The quotients that the table of a case contains, as names of columns.
std::vector<std::string> quotients_of(const Case& c);

/// The quotient with this name; none if it is not one of quotients_of().
std::optional<Quotient> find_quotient(const Case& c, const std::string& column);

/// The trace of the spectral columns: that of the centre, or the first one.
Vec2 trace_m(const Case& c);

} // namespace shearwake::optimise
