// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/optimise_options.hpp"
#include "studies/optimise/search/best_envelope.hpp"
#include "studies/optimise/search/variation.hpp"
#include "studies/optimise/search/waveform.hpp"

#include <optional>
#include <vector>

namespace shearwake::optimise {

/// An envelope of AM-STM, 1 - depth/2 (1 + cos(2 pi f t + phase)) at the knots.
struct AmEnvelope {
    double frequency_Hz = 0.0, depth = 0.0, phase_rad = 0.0;
    Envelope envelope;
};

/// The frequencies of AM-STM that are searched: those of the options, or whole numbers of periods
/// in the window with at least six knots per period.
std::vector<double> am_frequencies_Hz(const Case& c, const Knots& knots,
                                      const OptimiseOptions& options);

/// The AM-STM with the largest eta that meets the requirements, over these frequencies and a fine
/// grid of depths and phases; the unmodulated load if none is better, with eta = 0 if it does not
/// meet them either.
AmEnvelope best_am(const Forms& forms, const Knots& knots, const Required& required,
                   const std::vector<double>& frequencies_Hz);

/// One SM-STM on the path of the case.
struct SmCase {
    double frequency_Hz = 0.0, deviation_m_s = 0.0, phase_rad = 0.0;
    Case physics;
    bool is_same(const SmCase& other) const { return physics == other.physics; }
};
/// Its motion, relative to that of the case; none if it has no whole number of periods in the
/// window of the measures.
std::optional<MotionChange> motion_of(const SmCase& sm, const Case& c);

/// The first SM-STM cases of the search for the best one: one to five periods in the window of the
/// measures, four phases, and a deviation of 0.45 times the speed, or the frequencies and
/// deviations of the options. None without a constant speed along a path; cases that cannot be
/// computed, for example because the path ends within the window, are left out.
std::vector<SmCase> sm_cases(const Case& c, const OptimiseOptions& options);

/// The next cases, around one of them: phases that differ by `step` times 45 degrees, and unless
/// the options fix it, deviations that differ by `step` times 0.15 times the speed, up to 0.6 times
/// it.
std::vector<SmCase> sm_around(const Case& c, const SmCase& centre, double step,
                              const OptimiseOptions& options);

} // namespace shearwake::optimise
