// SPDX-License-Identifier: BSD-3-Clause
#include "neural/skin/skin_stress.hpp"

#include "base/constants.hpp"
#include "neural/skin/contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shearwake::neural {

double stress_per_load(double distance_mm, double depth_mm, double radius_mm) {
    const double xi = depth_mm / radius_mm, rho = distance_mm / radius_mm;
    const double q = rho * rho + xi * xi - 1.0;
    const double R = std::sqrt(q * q + 4.0 * xi * xi);
    const double phi = std::atan2(2.0 * xi, q), theta = std::atan(1.0 / xi);
    const double J01 = std::sin(0.5 * phi) / std::sqrt(R);
    const double J02 = std::sqrt(1.0 + xi * xi) * std::sin(1.5 * phi - theta) / (R * std::sqrt(R));
    return (J01 + xi * J02) / (two_pi * radius_mm * radius_mm);
}

std::size_t arrival_samples(double distance_mm, double radius_mm, double rate_Hz) {
    const double way_mm = std::max(distance_mm - radius_mm, 0.0);
    const double samples = std::nearbyint(way_mm / wave_speed_mm_s * rate_Hz);
    if (!(samples < 1e15)) return std::numeric_limits<std::size_t>::max(); // the wave never arrives
    return static_cast<std::size_t>(samples);
}

double wave_gain(double distance_mm, double depth_mm, double radius_mm) {
    if (!std::isfinite(distance_mm)) return 0.0;
    return sinking_profile(distance_mm, radius_mm) / (depth_mm * depth_mm);
}

} // namespace shearwake::neural
