// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"

#include <array>
#include <string>
#include <vector>

namespace shearwake {

/// What `shearwake optimise` varies.
enum class OptimisedPart { envelope, speed_profile, speed, size };
constexpr auto names_of(std::type_identity<OptimisedPart>) {
    return std::array{"envelope", "speed-profile", "speed", "size"};
}

/// [optimise]: what `shearwake optimise` computes for each case of a job.
struct OptimiseOptions {
    std::string maximise = "eta_period_1";
    std::vector<OptimisedPart> over = {OptimisedPart::envelope};
    double knot_s = 250e-6;
    std::vector<double> strengths = {0.6, 0.7, 0.8, 0.9};
    double uniformity = 0.0; // 0: no constraint
    int starts = 12;
    double factor_at_most = 1.5;                              // of the speed and the size
    int rounds = 6;                                           // of the search over the motion
    std::vector<double> am_frequencies_Hz, sm_frequencies_Hz; // empty: chosen
    std::vector<double> sm_deviations_m_s;                    // empty: chosen
    double robust_to = 0.0;                                   // 0: not computed
    std::vector<double> robust_strengths;                     // empty: all
    double update_rate_Hz = 0.0;                              // 0: no export
    int bits = 8;
    bool operator==(const OptimiseOptions&) const = default;
};

/// What is found, and under which constraints.
template <class Walk, Is<OptimiseOptions> Options>
void walk_search_fields(Walk& walk, Options& o) {
    walk(o.maximise,
         {.key = "maximise",
          .meaning = "column of the table that is maximised: `eta_period_1`, `sharpness_1`, or "
                     "the share of a band of `measure.bands_Hz`, such as `share_40_400_1` or "
                     "`velocity_share_40_400_1`. The field is that of the first depth of "
                     "`measure.depths_mm`"});
    walk(o.over, {.key = "over",
                  .given = Given::by_hand,
                  .fallback = "[\"envelope\"]",
                  .meaning = "what is varied: `\"envelope\"` and optionally `\"speed-profile\"` (a "
                             "speed that oscillates), `\"speed\"` (its mean), and `\"size\"` (of "
                             "the path)"});
    walk(o.knot_s, {.key = "knot_us",
                    .range = Range::between(20.0, 10000.0),
                    .meaning = "time between the knots of the envelope, with straight lines "
                               "between; changed slightly so that a whole number of them fits"});
    walk(o.strengths, {.key = "strength_at_least",
                       .range = Range::between(0.05, 1.0),
                       .meaning = "least rms over the focal disc, divided by that of the "
                                  "unmodulated load on the same path; one optimum per value"});
    walk(o.uniformity,
         {.key = "uniformity",
          .range = Range::between(0.0, 1.0),
          .meaning = "least uniformity of each optimum: the smallest rms of u over time along the "
                     "path, divided by its mean along the path; 0: no constraint"});
    walk(o.starts, {.key = "starts",
                    .range = Range::between(1.0, 10000.0),
                    .meaning = "number of envelopes from which the search starts"});
    walk(o.factor_at_most,
         {.key = "factor_at_most",
          .range = Range::between(1.001, 10.0),
          .meaning = "with `\"speed\"` or `\"size\"` in `over`: largest factor by which they "
                     "increase or decrease"});
    walk(o.rounds,
         {.key = "rounds",
          .range = Range::between(1.0, 1000.0),
          .meaning =
              "with more than the envelope in `over`: largest number of rounds of the search"});
}

/// With what the optimum is compared, and how it is exported.
template <class Walk, Is<OptimiseOptions> Options>
void walk_comparison_fields(Walk& walk, Options& o) {
    walk(o.am_frequencies_Hz,
         {.key = "am_frequency_Hz",
          .range = Range::between(1e-3, 1e5),
          .fallback = "whole numbers of periods in the window of the measures, with at least six "
                      "knots per period",
          .meaning = "frequencies of AM-STM with which the optimum is compared; all depths and "
                     "phases are searched"});
    walk(o.sm_frequencies_Hz,
         {.key = "sm_frequency_Hz",
          .range = Range::between(1e-3, 1e5),
          .fallback = "one to five periods in the window of the measures",
          .meaning = "frequencies of SM-STM with which the optimum is compared; the phase is "
                     "searched"});
    walk(o.sm_deviations_m_s,
         {.key = "sm_deviation_m_s",
          .range = Range::above(0.0),
          .fallback = "searched, up to 0.6 times the speed",
          .meaning = "speed deviations of SM-STM with which the optimum is compared"});
    walk(o.robust_to,
         {.key = "robust_to",
          .range = Range::between(0.0, 0.9),
          .meaning = "relative change, such as 0.2: each optimum is also computed with the "
                     "velocities c_s, the viscosities and the speed of the focus increased and "
                     "decreased by it; 0: not computed"});
    walk(o.robust_strengths,
         {.key = "robust_strength",
          .range = Range::between(0.05, 1.0),
          .fallback = "all values of `strength_at_least`",
          .meaning = "with `robust_to`: the values of `strength_at_least` to which it applies"});
    walk(o.update_rate_Hz,
         {.key = "update_rate_Hz",
          .range = Range::between(10.0, 1e6),
          .fallback = "none",
          .meaning = "rate at which a display updates its amplitude: the waveforms are exported "
                     "as CSV at this rate, and the loss is computed; changed slightly so that a "
                     "whole number of updates fits the period"});
    walk(o.bits, {.key = "bits",
                  .range = Range::between(1.0, 16.0),
                  .meaning = "with `update_rate_Hz`: number of bits of the sound pressure "
                             "amplitude in the exported waveform"});
}

template <class Walk, Is<OptimiseOptions> Options>
void walk_fields(Walk& walk, Options& o) {
    walk.section("optimise");
    walk_search_fields(walk, o);
    walk_comparison_fields(walk, o);
}

} // namespace shearwake
