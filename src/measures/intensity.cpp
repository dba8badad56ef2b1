// SPDX-License-Identifier: BSD-3-Clause
#include "measures/intensity.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace shearwake::measures {

double impulse_N_s(const Load& load, double until_s) {
    constexpr double steps_a_period = 200.0, fewest_steps = 256.0;
    const double end = std::min(until_s, off_time_s(load.modulation.trajectory));
    if (!(end > 0.0)) return 0.0;
    double highest_Hz = greatest_envelope_frequency_Hz(load.modulation.envelope);
    if (const auto* carrier = std::get_if<ResolvedCarrier>(&load.carrier))
        highest_Hz += carrier->frequency_Hz;

    const double steps = std::ceil(std::max(fewest_steps, steps_a_period * highest_Hz * end));
    const double dt = end / steps;
    // amplitude() instead of force_N(), since the end of the path is handled here. Steering changes
    // the force of an array slowly: it is interpolated linearly between these times.
    constexpr int pieces = 64;
    std::vector<double> times;
    for (int i = 0; i <= pieces; ++i)
        times.push_back(end * i / pieces);
    const std::vector<double> areas = force_areas_m2(load, times);
    const auto area = [&](double n) {
        const double at = n / steps * pieces, piece = std::min(std::floor(at), pieces - 1.0);
        const auto i = static_cast<std::size_t>(piece);
        return areas[i] + (areas[i + 1] - areas[i]) * (at - piece);
    };
    double sum = 0.5 * (areas.front() * amplitude(load, 0.0) + areas.back() * amplitude(load, end));
    for (double n = 1.0; n < steps; n += 1.0)
        sum += area(n) * amplitude(load, n * dt);
    return load.peak_Pa * sum * dt;
}

} // namespace shearwake::measures
