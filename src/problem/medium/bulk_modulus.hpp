// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/medium/medium.hpp"

#include <cstddef>

namespace shearwake {

struct Speeds {
    double c_p_m_s = 0.0;
    double c_s_m_s = 0.0;
    bool operator==(const Speeds&) const = default;
};

/// c_p / c_s above which lambda + 2/3 mu > 0. Otherwise, the material would expand under
/// hydrostatic pressure.
constexpr double least_speed_ratio = 1.1547005383792515; // 2 / sqrt 3
bool has_positive_bulk_modulus(const Speeds& speeds);

/// The speeds with the smallest c_p / c_s within layer number `layer`, including the map; with
/// `body`, within the part of the layer that the body occupies. The ratio is not smaller between
/// the points of a map.
Speeds softest_against_pressure(const Medium& medium, std::size_t layer,
                                const Body* body = nullptr);

/// Top and bottom of the layer; the bottom of a half-space is at infinity.
DepthRange depths(const Medium& medium, std::size_t layer);

} // namespace shearwake
