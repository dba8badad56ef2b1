// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/optimise_options.hpp"
#include "problem/load/motion/trajectory.hpp"

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

/// An envelope as a display accepts it: levels of the sound pressure amplitude from 0 to 2^bits -
/// 1, at equal intervals. The force is proportional to the square of the level.
struct Waveform {
    double interval_s = 0.0;
    int bits = 0;
    bool repeat = false;
    std::vector<int> levels;

    int greatest_level() const { return (1 << bits) - 1; }
};

/// The envelope of the force at exactly this update rate, rounded to the nearest level; the last
/// update of a single pass is at or after its end. Throws UsageError if the period of the load is
/// not a whole number of updates, or for more updates than an envelope of a job may have.
Waveform waveform_of(const Knots& knots, const Eigen::VectorXd& values, double update_rate_Hz,
                     int bits);

/// The force of a waveform, linear between the updates.
SampledGain gain_of(const Waveform& waveform);

/// t_us, x_mm, y_mm, level, pressure and force (both relative to the greatest), one row per update.
/// `trajectory` is that of the focus.
std::string csv_text(const Waveform& waveform, const Trajectory& trajectory);
/// [[load.modulation.envelope]] of a job that reproduces the waveform.
std::string toml_text(const Waveform& waveform);

} // namespace shearwake::optimise
