#pragma once

#include <cstddef>
#include <span>

namespace shearwake::neural {

/// Speed of the wave that carries a pin's motion along the skin.
inline constexpr double wave_speed_mm_s = 8000.0;

/// Axial stress at depth z and distance r from the middle of a flat pin of radius a, over its load
/// [1/mm2], compression positive (Sneddon 1946, eq. 6.7 and its integrals J01, J02):
///     (J01 + xi J02) / (2 pi a^2),   xi = z/a,  rho = r/a.
double stress_per_load(double distance_mm, double depth_mm, double radius_mm);

/// The samples by which the wave of a pin's motion comes later at a distance from its middle: whole
/// ones, halves to even.
std::size_t arrival_samples(double distance_mm, double radius_mm, double rate_Hz);

/// How strongly a pin's load rate comes through to a receptor [1/mm3]:
/// sinking_profile(distance) / depth^2; 0 at an infinite distance.
double wave_gain(double distance_mm, double depth_mm, double radius_mm);

/// sum[k] += gain line[k - delay], and nothing where k < delay.
void add_delayed(std::span<const double> line, std::size_t delay, double gain,
                 std::span<double> sum);

} // namespace shearwake::neural
