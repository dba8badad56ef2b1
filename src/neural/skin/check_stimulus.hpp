// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "neural/hand/hand.hpp"
#include "neural/skin/contact.hpp"
#include "problem/case/plan.hpp"

#include <span>
#include <vector>

namespace shearwake::neural {

/// Whether traces have a beginning and an end, or are one period of a motion that repeats for ever.
enum class Course { once, periodic };

/// Errors and warnings about pins and their traces: radius, overlap, non-finite values, sampling,
/// mixed signs, jumps at the ends without silence, pins outside of the skin (`skin_mm` is its
/// outline; empty: unbounded). Not collective.
std::vector<Remark> check_stimulus(const PinStimulus& stimulus, double silence_s,
                                   const Polygon& skin_mm, Course course = Course::once);

/// Errors and warnings about the traces of stress [Pa] at receptors, one line per afferent. Not
/// collective.
std::vector<Remark> check_stress(std::span<const std::vector<double>> compression_Pa,
                                 double rate_Hz, std::size_t afferents, double silence_s,
                                 Course course = Course::once);

/// The stimulus with a pin radius reduced where pins would overlap.
PinStimulus without_overlap(PinStimulus stimulus);

} // namespace shearwake::neural
