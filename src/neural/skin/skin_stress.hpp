// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

namespace shearwake::neural {

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
