// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

/// The envelope of the force at this update rate, rounded to the nearest level. In the periodic
/// regime the rate is changed slightly, so that a whole number of updates fits into the period.
/// Throws UsageError for more updates than an envelope of a job may have.
Waveform waveform_of(const Knots& knots, const Eigen::VectorXd& values, double update_rate_Hz,
                     int bits);

/// The force of a waveform, linear between the updates.
SampledGain gain_of(const Waveform& waveform);

/// t_us, level, pressure and force (both relative to the greatest), one row per update.
std::string csv_text(const Waveform& waveform);
/// [[load.modulation.envelope]] of a job that reproduces the waveform.
std::string toml_text(const Waveform& waveform);

} // namespace shearwake::optimise
