#pragma once

#include "base/vec3.hpp"

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace shearwake {

/// A 3-D map of properties on a regular grid, read from a file. Trilinear between its points; the
/// nearest point within half a spacing beyond its rim; absent further out. A direction with a
/// single point and spacing 0 is one in which nothing changes: the map goes on for ever there.
struct MaterialMap {
    std::string file;
    std::string content_hash; // 16 hex digits of everything but the file's name: hash_of
    std::array<std::ptrdiff_t, 3> counts{};
    Vec3 origin_m, spacing_m; // of the first point; between points
    // Value (i, j, k) stands at [(i counts[1] + j) counts[2] + k]: z fastest. Empty: of the layer.
    std::vector<double> c_s_m_s, c_p_m_s, density_kg_m3, viscosity_Pa_s;
    bool operator==(const MaterialMap& other) const { return content_hash == other.content_hash; }
};

/// What content_hash must hold.
std::string hash_of(const MaterialMap& map);

/// The map's values at a point; absent ones are those of the layer.
struct MapSample {
    std::optional<double> c_s_m_s, c_p_m_s, density_kg_m3, viscosity_Pa_s;
};
MapSample sample(const MaterialMap& map, Vec3 at_m);

/// The depths that the map says something about, rim included; infinite for a single point.
struct DepthRange {
    double top_m, bottom_m;
};
DepthRange depths(const MaterialMap& map);

} // namespace shearwake
