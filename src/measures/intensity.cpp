// SPDX-License-Identifier: BSD-3-Clause
#include "measures/intensity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace shearwake::measures {

double impulse_N_s(const Load& load, double until_s) {
    constexpr double steps_a_period = 100.0, fewest_steps = 10000.0;
    constexpr std::size_t most_rough = 400;
    const double end = std::min(until_s, off_time_s(load.modulation.trajectory));
    if (!(end > 0.0)) return 0.0;
    double highest_Hz = greatest_envelope_frequency_Hz(load.modulation.envelope);
    if (const auto* carrier = std::get_if<ResolvedCarrier>(&load.carrier))
        highest_Hz += carrier->frequency_Hz;

    // The Gauss rule of two points in each step. The many steps are for the jumps of a steered
    // array's force by up to a few per cent, where its focus is updated or its path begins again.
    const double steps = std::ceil(std::max(fewest_steps, steps_a_period * highest_Hz * end));
    const double dt_s = end / steps;
    std::vector<double> times_s;
    for (double n = 0.0; n < steps; n += 1.0)
        for (const double side : {-1.0, 1.0})
            times_s.push_back((n + 0.5 + 0.5 * side / std::numbers::sqrt3) * dt_s);
    const std::vector<double> areas_m2 = force_areas_m2(load, times_s, most_rough);
    double sum = 0.0;
    for (std::size_t n = 0; n < times_s.size(); ++n)
        sum += areas_m2[n] * amplitude(load, times_s[n]);
    return load.peak_Pa * sum * 0.5 * dt_s;
}

} // namespace shearwake::measures
