#pragma once

#include "model/check.hpp"
#include "neural/contact.hpp"
#include "neural/polygon.hpp"

#include <span>
#include <vector>

namespace shearwake::neural {

/// What is wrong (error) or doubtful (warning) with pins and their traces, with the numbers:
/// radius, overlap, numbers that are not finite, sampling, mixed signs, jumps at the ends without
/// silence, pins off the skin (`skin_mm`: its outline, or empty: endless).
std::vector<Remark> check_stimulus(const PinStimulus& stimulus, double silence_s,
                                   const Polygon& skin_mm);

/// The same of the stress [Pa] at receptors, a line for each of so many.
std::vector<Remark> check_stress(std::span<const std::vector<double>> compression_Pa,
                                 double rate_Hz, std::size_t afferents, double silence_s);

/// The stimulus with pins that do not overlap: a smaller radius where they would.
PinStimulus without_overlap(PinStimulus stimulus);

} // namespace shearwake::neural
