// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/acoustics/lens_mesh.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace shearwake {
namespace {

/// A corner of the grid of pixels.
struct Corner {
    std::ptrdiff_t i = 0, j = 0;
};

class Columns {
public:
    explicit Columns(const HeightMap& map) : map_(map) {}

    double height(std::ptrdiff_t i, std::ptrdiff_t j) const {
        if (i < 0 || j < 0 || i >= map_.side || j >= map_.side) return 0.0;
        return std::max(0.0, map_.heights_m[static_cast<std::size_t>(i * map_.side + j)]);
    }
    Vec3 point(Corner at, double z_m) const {
        const double half = 0.5 * static_cast<double>(map_.side);
        return {(static_cast<double>(at.i) - half) * map_.pixel_m,
                (static_cast<double>(at.j) - half) * map_.pixel_m, z_m};
    }
    /// The heights between `low` and `high` at which walls around this corner begin or end, so that
    /// all of them share the same edges.
    std::vector<double> heights_at(Corner at, double low, double high) const {
        std::vector<double> heights = {low, high};
        for (const std::ptrdiff_t i : {at.i - 1, at.i})
            for (const std::ptrdiff_t j : {at.j - 1, at.j})
                if (height(i, j) > low && height(i, j) < high) heights.push_back(height(i, j));
        std::sort(heights.begin(), heights.end());
        heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
        return heights;
    }
    /// The wall above the edge from `a` to `b`, seen from outside with `a` on the left.
    void add_wall(Corner a, Corner b, double low, double high, std::vector<Triangle>& to) const {
        const std::vector<double> left = heights_at(a, low, high), right = heights_at(b, low, high);
        std::size_t l = 0, r = 0;
        while (l + 1 < left.size() || r + 1 < right.size()) {
            const bool is_left_next =
                r + 1 == right.size() || (l + 1 < left.size() && left[l + 1] <= right[r + 1]);
            const Vec3 at_left = point(a, left[l]), at_right = point(b, right[r]);
            if (is_left_next)
                to.push_back({at_left, at_right, point(a, left[++l])});
            else
                to.push_back({at_left, at_right, point(b, right[++r])});
        }
    }

private:
    const HeightMap& map_;
};

Vec3 cross(Vec3 a, Vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

void append(std::string& bytes, float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (int shift = 0; shift < 32; shift += 8)
        bytes += static_cast<char>((bits >> shift) & 0xffU);
}

} // namespace

std::vector<Triangle> surface_of(const HeightMap& map) {
    const Columns columns(map);
    std::vector<Triangle> triangles;
    for (std::ptrdiff_t i = 0; i < map.side; ++i)
        for (std::ptrdiff_t j = 0; j < map.side; ++j) {
            const double top = columns.height(i, j);
            if (top == 0.0) continue;
            const Corner sw{i, j}, se{i + 1, j}, ne{i + 1, j + 1}, nw{i, j + 1};
            const auto at = [&](Corner corner, double z_m) { return columns.point(corner, z_m); };
            triangles.push_back({at(sw, top), at(se, top), at(ne, top)});
            triangles.push_back({at(sw, top), at(ne, top), at(nw, top)});
            triangles.push_back({at(sw, 0.0), at(ne, 0.0), at(se, 0.0)});
            triangles.push_back({at(sw, 0.0), at(nw, 0.0), at(ne, 0.0)});
            const auto wall = [&](Corner a, Corner b, double beyond) {
                if (beyond < top) columns.add_wall(a, b, beyond, top, triangles);
            };
            wall(sw, se, columns.height(i, j - 1));
            wall(se, ne, columns.height(i + 1, j));
            wall(ne, nw, columns.height(i, j + 1));
            wall(nw, sw, columns.height(i - 1, j));
        }
    return triangles;
}

std::string binary_stl(const std::vector<Triangle>& triangles) {
    std::string bytes = "shearwake lens, millimetres";
    bytes.resize(80, ' ');
    const auto count = static_cast<std::uint32_t>(triangles.size());
    for (int shift = 0; shift < 32; shift += 8)
        bytes += static_cast<char>((count >> shift) & 0xffU);
    for (const Triangle& t : triangles) {
        const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
        const double length = norm(normal);
        for (const Vec3& v : {(1.0 / length) * normal, 1e3 * t[0], 1e3 * t[1], 1e3 * t[2]})
            for (const double component : {v.x, v.y, v.z})
                append(bytes, static_cast<float>(component));
        bytes.append(2, '\0');
    }
    return bytes;
}

} // namespace shearwake
