// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/optimise_options.hpp"

#include <optional>
#include <string>
#include <vector>

namespace shearwake::optimise {

/// Largest deviation of an oscillating speed that is searched, relative to the mean.
constexpr double largest_deviation = 0.6;

/// Whether the case is valid, its window of the measures fits, and in the periodic regime its
/// period is that of its load.
bool can_be_computed(const Case& c);

/// Whether the focus moves along a path at constant speed without rests, and this speed.
bool has_speed(const Case& c);
double speed_m_s(const Case& c);

/// The same load with an oscillating speed, SM-STM. Only for a case with has_speed().
Case with_oscillating_speed(Case c, double frequency_Hz, double deviation_m_s, double phase_rad);

/// A change of the motion of the focus along its path, relative to the job. The speed is
///     v (1 + sine sin(2 pi f t) + cosine cos(2 pi f t)), v the changed mean.
struct MotionChange {
    double size = 1.0, speed = 1.0;  // factors
    int periods = 0;                 // of the speed profile in the window of the measures
    double sine = 0.0, cosine = 0.0; // of the speed profile
    bool operator==(const MotionChange&) const = default;
};

/// The case with a changed motion. Its times, among them the window of the measures and those of an
/// envelope of samples, are scaled with the duration of a pass. None if it is not a valid case
/// then, for example because the path leaves the domain. Only for a case with has_speed().
std::optional<Case> with_motion(const Case& c, const MotionChange& change);

/// The changes around one of them that a round of the search tries: each varied quantity increased
/// and decreased by `step`, or by a fraction of it.
std::vector<MotionChange> changes_around(const MotionChange& centre, double step,
                                         const OptimiseOptions& options);

/// Another tissue or speed, in which the robustness of an optimum is computed.
struct Difference {
    std::string name;
    double c_s = 1.0, viscosity = 1.0, speed = 1.0; // factors
};
/// c_s and viscosities increased and decreased by this relative change in all combinations, and the
/// speed increased and decreased.
std::vector<Difference> differences_by(double relative);

/// The case in the other tissue or at the other speed; none if it is not a valid case then.
std::optional<Case> with_difference(const Case& c, const Difference& difference);

} // namespace shearwake::optimise
