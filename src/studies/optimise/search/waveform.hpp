// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/load/motion/trajectory.hpp"
#include "studies/optimise/search/knots.hpp"

#include <string>
#include <vector>

namespace shearwake::optimise {

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
