#include "measures/intensity.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake {

double impulse_N_s(const Load& load, double until_s) {
    constexpr double steps_a_period = 200.0, fewest_steps = 256.0;
    const double end = std::min(until_s, off_time_s(load.modulation.trajectory));
    if (!(end > 0.0)) return 0.0;
    double highest_Hz = greatest_envelope_frequency_Hz(load.modulation.envelope);
    if (const auto* carrier = std::get_if<ResolvedCarrier>(&load.carrier))
        highest_Hz += carrier->frequency_Hz;

    const double steps = std::ceil(std::max(fewest_steps, steps_a_period * highest_Hz * end));
    const double dt = end / steps;
    // amplitude() and not force_N(): the end of the path is known here, once.
    double sum = 0.5 * (amplitude(load, 0.0) + amplitude(load, end));
    for (double n = 1.0; n < steps; n += 1.0)
        sum += amplitude(load, n * dt);
    return load.peak_Pa * spectrum(load.footprint, 0.0, 0.0) * sum * dt;
}

} // namespace shearwake
