// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/load/load.hpp"

#include <string>
#include <vector>

namespace shearwake {

/// The period of a load that repeats for ever, or the reason why it has none.
struct LoadPeriod {
    double period_s = 0.0;
    std::string trouble; // a sentence without a subject: "has ..."; empty: there is a period
};

/// The frequencies with which the parts of a load repeat [Hz]: of its paths, swings, speeds and
/// gains, of a resolved carrier, and of the updates of an array whose focus moves.
std::vector<double> frequencies_of(const Load& load);

/// The least common period of these frequencies, up to `longest_s`: the shortest time that is a
/// whole number of periods of each, to 1e-6 of a period. A load whose path ends, which rises or
/// falls once, or which is constant, has none.
LoadPeriod least_period(const Load& load, double longest_s);

} // namespace shearwake
