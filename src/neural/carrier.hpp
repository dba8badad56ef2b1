#pragma once

#include "model/afferents.hpp"
#include "neural/contact.hpp"

namespace shearwake::neural {

/// Fewest samples of a carrier's cycle: with fewer, harmonics of what is rectified or squared fall
/// onto what is slow, and a carrier at a multiple of the sampling rate onto nothing or onto its
/// bare envelope.
inline constexpr double fewest_samples_a_cycle = 5.0;

/// All pins moved alike for `duration_s`. Throws UsageError for a carrier that its sampling cannot
/// carry.
PinStimulus carrier_stimulus(const CarrierInput& carrier, std::vector<Vec2> pins_mm,
                             double radius_mm, double duration_s);

} // namespace shearwake::neural
