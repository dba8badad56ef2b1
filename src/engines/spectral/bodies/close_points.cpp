// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/close_points.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace shearwake::spectral {
namespace {

constexpr double same_depth = 0.3, same_point = 0.4;

/// Moves points at almost the same depth to one.
void join_depths(double within_m, std::vector<Vec3>& points) {
    std::sort(points.begin(), points.end(),
              [](Vec3 a, Vec3 b) { return std::tie(a.z, a.x, a.y) < std::tie(b.z, b.x, b.y); });
    for (std::size_t begin = 0, end; begin < points.size(); begin = end) {
        for (end = begin; end < points.size() && points[end].z <= points[begin].z + within_m;)
            ++end;
        const double depth_m = 0.5 * (points[begin].z + points[end - 1].z);
        for (std::size_t i = begin; i < end; ++i)
            points[i].z = depth_m;
    }
}

/// Replaces points that are too close to each other, as at the rim of a flat body, by their mean,
/// which preserves the symmetry. The points are sorted by depth.
void join_points(double across_m, double down_m, std::vector<Vec3>& points) {
    std::vector<std::size_t> group(points.size());
    std::iota(group.begin(), group.end(), std::size_t{0});
    const auto first_of = [&](std::size_t i) {
        while (group[i] != i)
            i = group[i];
        return i;
    };
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = i + 1;
             j < points.size() && points[j].z - points[i].z < same_point * down_m; ++j) {
            const Vec3 apart = points[j] - points[i];
            if (norm({apart.x / across_m, apart.y / across_m, apart.z / down_m}) < same_point) {
                const std::size_t a = first_of(i), b = first_of(j);
                group[std::max(a, b)] = std::min(a, b);
            }
        }
    std::vector<Vec3> sums(points.size());
    std::vector<double> counts(points.size(), 0.0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        sums[first_of(i)] = sums[first_of(i)] + points[i];
        counts[first_of(i)] += 1.0;
    }
    std::vector<Vec3> joined;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (counts[i] > 0.0)
            joined.push_back(counts[i] > 1.0 ? (1.0 / counts[i]) * sums[i] : sums[i]);
    points = std::move(joined);
}

} // namespace

void join_close_points(double across_m, double down_m, std::vector<Vec3>& points) {
    join_depths(same_depth * down_m, points);
    join_points(across_m, down_m, points);
}

} // namespace shearwake::spectral
