#pragma once

#include "model/medium.hpp"

#include <cstddef>

namespace shearwake {

struct Speeds {
    double c_p_m_s = 0.0;
    double c_s_m_s = 0.0;
    bool operator==(const Speeds&) const = default;
};

/// c_p over c_s above which lambda + 2/3 mu > 0: else the material would swell when pressed from
/// all sides.
constexpr double least_speed_ratio = 1.1547005383792515; // 2 / sqrt 3
bool has_positive_bulk_modulus(const Speeds& speeds);

/// The speeds of which c_p / c_s is least within layer number `layer`, the map in it; with `body`,
/// within the part of it where the body is. Between a map's points the ratio is no smaller.
Speeds softest_against_pressure(const Medium& medium, std::size_t layer,
                                const Body* body = nullptr);

/// The layer's top and bottom; infinite below a half-space.
DepthRange depths(const Medium& medium, std::size_t layer);

} // namespace shearwake
