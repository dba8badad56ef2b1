#pragma once

#include "model/afferents.hpp"
#include "neural/contact.hpp"

namespace shearwake::neural {

/// All pins moved alike for `duration_s`. Throws UsageError for a carrier that its sampling cannot
/// carry.
PinStimulus carrier_stimulus(const CarrierInput& carrier, std::vector<Vec2> pins_mm,
                             double radius_mm, double duration_s);

} // namespace shearwake::neural
