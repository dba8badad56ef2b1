// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace shearwake {

/// A 3-D map of properties on a regular grid, read from a file. Interpolation is trilinear between
/// its points. Within half a spacing outside the boundary, the nearest point applies; further
/// outside, the map has no effect. In a direction with a single point and spacing 0, the map is
/// constant and unbounded.
struct MaterialMap {
    std::string file;
    std::string content_hash; // 16 hex digits of everything but the file's name: hash_of
    std::array<std::ptrdiff_t, 3> counts{};
    Vec3 origin_m, spacing_m; // position of the first point; distance between points
    // Value (i, j, k) stands at [(i counts[1] + j) counts[2] + k]: z fastest. Empty: the property
    // of the layer applies.
    std::vector<double> c_s_m_s, c_p_m_s, density_kg_m3, viscosity_Pa_s;
    std::string contents; // what was read, for the user; one line
    bool operator==(const MaterialMap& other) const { return content_hash == other.content_hash; }
};

/// The value of content_hash.
std::string hash_of(const MaterialMap& map);

/// The values of the map at a point; for absent ones, those of the layer apply.
struct MapSample {
    std::optional<double> c_s_m_s, c_p_m_s, density_kg_m3, viscosity_Pa_s;
};
MapSample sample(const MaterialMap& map, Vec3 at_m);

/// Passes the points of the map between which sample() interpolates, with their weights, or no
/// values with weight 1 where the map has no effect.
void each_neighbour(const MaterialMap& map, Vec3 at_m,
                    const std::function<void(double share, const MapSample& value)>& use);

/// The range of depths that the map covers, including its boundary; infinite for a single point.
struct DepthRange {
    double top_m, bottom_m;
};
DepthRange depths(const MaterialMap& map);

} // namespace shearwake
