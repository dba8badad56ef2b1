// SPDX-License-Identifier: BSD-3-Clause
#include "neural/skin/carrier.hpp"

#include "base/constants.hpp"
#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::neural {
namespace {

/// Angle 2 pi f t at sample k. Complete periods are subtracted first, so that it is exact after
/// millions of samples.
double turn(double frequency_Hz, double rate_Hz, std::size_t k) {
    const double periods = frequency_Hz * static_cast<double>(k) / rate_Hz;
    return two_pi * (periods - std::floor(periods));
}

} // namespace

PinStimulus carrier_stimulus(const CarrierInput& carrier, std::vector<Vec2> pins_mm,
                             double radius_mm, double duration_s) {
    const double rate_Hz = carrier.sampling_Hz;
    if (rate_Hz < fewest_samples_a_cycle * carrier.frequency_Hz * (1.0 - 1e-9))
        throw UsageError(fmt::format(
            "a carrier of {:g} kHz sampled at {:g} kHz has {:.3g} samples per cycle and aliases; "
            "at least {:g} are needed: set sampling_kHz to at least {:g}",
            1e-3 * carrier.frequency_Hz, 1e-3 * rate_Hz, rate_Hz / carrier.frequency_Hz,
            fewest_samples_a_cycle, 1e-3 * fewest_samples_a_cycle * carrier.frequency_Hz));
    PinStimulus stimulus{.at_mm = std::move(pins_mm), .radius_mm = radius_mm, .rate_Hz = rate_Hz};
    const auto samples = static_cast<std::size_t>(std::llround(duration_s * rate_Hz));
    stimulus.indentation_mm = Lines(stimulus.at_mm.size(), samples);
    std::vector<double> trace(samples);
    for (std::size_t k = 0; k < samples; ++k) {
        const double am = std::cos(turn(carrier.am_frequency_Hz, rate_Hz, k));
        const double m =
            carrier.am_frequency_Hz > 0.0 ? 1.0 - 0.5 * carrier.am_depth * (1.0 + am) : 1.0;
        const double mc = m * std::sin(turn(carrier.frequency_Hz, rate_Hz, k));
        trace[k] = 1e3 * carrier.amplitude_m *
                   (carrier.wave == CarrierWave::signed_     ? mc
                    : carrier.wave == CarrierWave::rectified ? std::max(mc, 0.0)
                                                             : mc * mc);
    }
    for (std::size_t p = 0; p < stimulus.at_mm.size(); ++p)
        std::copy(trace.begin(), trace.end(), stimulus.indentation_mm.line(p).begin());
    return stimulus;
}

} // namespace shearwake::neural
