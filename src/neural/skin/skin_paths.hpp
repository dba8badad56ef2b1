// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "neural/hand/hand.hpp"

#include <cstddef>
#include <functional>
#include <vector>

namespace shearwake::neural {

/// Path lengths of waves from every pin to a receptor [mm]; infinite if there is no path.
using SkinPaths = std::function<std::vector<double>(Vec2 receptor_mm)>;

/// Straight lines on an unbounded flat sheet of skin.
SkinPaths straight_paths(std::vector<Vec2> pins_mm);

/// Shortest paths that stay within an outline: around the corners between fingers, not across the
/// gap. A shortest path bends only at reflex corners of the outline. The paths are therefore found
/// exactly by Dijkstra's algorithm on the visibility graph. There are no paths from or to points
/// outside of the skin. Not collective.
SkinPaths paths_within(const Polygon& outline_mm, std::vector<Vec2> pins_mm);

/// Speed of the wave that transports a pin's motion along the skin. No function here is collective.
inline constexpr double wave_speed_mm_s = 8000.0;

/// Axial stress at depth z and distance r from the centre of a flat pin of radius a, per load
/// [1/mm2], positive in compression (Sneddon 1946, eq. 6.7 and its integrals J01, J02):
///     (J01 + xi J02) / (2 pi a^2),   xi = z/a,  rho = r/a.
double stress_per_load(double distance_mm, double depth_mm, double radius_mm);

/// Delay of the wave of a pin's motion at a distance from the pin's centre, rounded to an integer
/// number of samples (ties to even).
std::size_t arrival_samples(double distance_mm, double radius_mm, double rate_Hz);

/// Gain from a pin's load rate to the dynamic term of a receptor [1/mm3]: sinking_profile(distance)
/// / depth^2; 0 at infinite distance.
double wave_gain(double distance_mm, double depth_mm, double radius_mm);

} // namespace shearwake::neural
