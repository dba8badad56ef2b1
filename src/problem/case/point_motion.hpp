// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vec2.hpp"

#include <optional>
#include <vector>

namespace shearwake {

/// The motion of some points of the surface, uniformly sampled from t = 0.
struct PointMotion {
    std::vector<Vec2> at_m;
    double rate_Hz = 0.0;
    std::vector<std::vector<double>> u_m; // one row per point, positive into the skin
    std::optional<double> radius_m;       // radius of the pins, if known
};

/// The stress at some receptors, uniformly sampled from t = 0.
struct PointStress {
    double rate_Hz = 0.0;
    std::vector<std::vector<double>> compression_Pa; // one row per receptor
};

} // namespace shearwake
