// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/work.hpp"

namespace shearwake::layered::kinds {

// Unit: one point, time sample and depth; with the spectra in caches or in memory.
inline constexpr engines::WorkKind of_sample = {"layered.sample.cached", 3e-9};
inline constexpr engines::WorkKind of_far_sample = {"layered.sample.memory", 4e-9};
inline constexpr engines::WorkKind of_load = {"layered.load", 6e-9}; // for loads that move in y
// Unit: one point, frame and depth; in caches or in memory.
inline constexpr engines::WorkKind of_frame = {"layered.frame.cached", 4e-9};
inline constexpr engines::WorkKind of_far_frame = {"layered.frame.memory", 4.5e-9};
inline constexpr engines::WorkKind of_response = {"layered.response",
                                                  9e-7}; // per evaluation of H and layer
// Unit: one product of a node of the contour and a radius, see radial_products().
inline constexpr engines::WorkKind of_radial = {"layered.radial", 5e-10};
inline constexpr engines::WorkKind of_expansion = {"layered.expansion",
                                                   2.5e-9}; // per point, time sample and depth
// The same with open edges, where planes are sampled and transformed.
inline constexpr engines::WorkKind of_open_expansion = {"layered.expansion.open", 2e-8};

} // namespace shearwake::layered::kinds
