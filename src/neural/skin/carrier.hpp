// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "neural/skin/contact.hpp"
#include "problem/case/afferents.hpp"

namespace shearwake::neural {

/// A stimulus of `duration_s` in which all pins move identically. Throws UsageError if the sampling
/// rate is too low for the carrier. Not collective.
PinStimulus carrier_stimulus(const CarrierInput& carrier, std::vector<Vec2> pins_mm,
                             double radius_mm, double duration_s);

} // namespace shearwake::neural
