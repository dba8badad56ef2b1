#pragma once

#include "base/vec2.hpp"

#include <optional>
#include <vector>

namespace shearwake {

/// How some points of the surface move, regularly sampled from t = 0 on.
struct PointMotion {
    std::vector<Vec2> at_m;
    double rate_Hz = 0.0;
    std::vector<std::vector<double>> u_m; // one line a point, positive into the skin
    std::optional<double> radius_m;       // of pins, if it is known
};

/// The stress at some receptors, likewise.
struct PointStress {
    double rate_Hz = 0.0;
    std::vector<std::vector<double>> compression_Pa; // one line a receptor
};

} // namespace shearwake
