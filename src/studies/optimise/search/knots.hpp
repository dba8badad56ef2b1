// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/optimise_options.hpp"

#include <Eigen/Dense>
#include <string>
#include <vector>

namespace shearwake::optimise {

/// The knots of an envelope, between which it is linear: at t = 0, interval, 2 interval, ..., in
/// the transient regime up to the instant of the measures and in the periodic regime over one
/// period.
struct Knots {
    Eigen::Index count = 0;
    double interval_s = 0.0;
    bool repeat = false;

    double at_s(Eigen::Index knot) const { return static_cast<double>(knot) * interval_s; }
};

/// The knots of a case, about `interval_s` apart.
Knots knots_of(const Case& c, double interval_s);

/// The reason why the case cannot be optimised; empty if it can.
std::string why_not(const Case& c, const OptimiseOptions& options);

/// The case with this envelope, given by its values at the knots.
Case with_envelope(Case c, const Knots& knots, const Eigen::VectorXd& values);

/// The case whose envelope is 1 at one knot and 0 at all others, which stores every frame of the
/// first depth and the trace of the spectral columns, and nothing else.
Case knot_case(const Case& c, const Knots& knots, Eigen::Index knot);

/// The window of the measures over periods [s].
double window_s(const Case& c);

} // namespace shearwake::optimise
