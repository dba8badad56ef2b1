// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "case/optimise_options.hpp"
#include "optimise/best_envelope.hpp"
#include "optimise/knots.hpp"
#include "optimise/variation.hpp"

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

/// The AM-STM with the largest eta that has at least this strength, over these frequencies and a
/// fine grid of depths and phases.
AmEnvelope best_am(const Forms& forms, const Knots& knots, double strength,
                   const std::vector<double>& frequencies_Hz);

/// One SM-STM on the path of the case.
struct SmCase {
    double frequency_Hz = 0.0, deviation_m_s = 0.0, phase_rad = 0.0;
    Case physics;
};
/// Its motion, relative to that of the case; none if it has no whole number of periods in the
/// window of the measures.
std::optional<MotionChange> motion_of(const SmCase& sm, const Case& c);

/// The SM-STM cases with which an optimum is compared; none without a constant speed along a path.
std::vector<SmCase> sm_cases(const Case& c, const OptimiseOptions& options);

} // namespace shearwake::optimise
