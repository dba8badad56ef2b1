// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/drawn_shape.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake {
namespace {

std::vector<Vec2> points_along(const Curve& path, double step_m) {
    const double length = length_m(path);
    const auto steps = std::max<std::ptrdiff_t>(1, std::lround(std::ceil(length / step_m)));
    std::vector<double> arcs;
    for (std::ptrdiff_t i = 0; i <= steps; ++i)
        arcs.push_back(length * static_cast<double>(i) / static_cast<double>(steps));
    const auto corners = corners_m(path);
    arcs.insert(arcs.end(), corners.begin(), corners.end());
    std::sort(arcs.begin(), arcs.end());
    std::vector<Vec2> points;
    for (const double arc : arcs)
        points.push_back(point_m(path, arc));
    return points;
}

template <class Part>
const Part* first_of(const Trajectory& trajectory) {
    for (const Mover& mover : trajectory.parts)
        if (const auto* part = std::get_if<Part>(&mover)) return part;
    return nullptr;
}

} // namespace

std::vector<std::vector<Vec2>> drawn_shape(const Modulation& modulation, double step_m) {
    Vec2 rest{};
    for (const Mover& mover : modulation.trajectory.parts)
        if (const auto* hold = std::get_if<Hold>(&mover)) rest = rest + hold->at_m;

    std::vector<Vec2> line = {{0.0, 0.0}};
    if (const auto* travel = first_of<Travel>(modulation.trajectory))
        line = points_along(travel->path, step_m);
    else if (const auto* swing = first_of<Swing>(modulation.trajectory))
        line = points_along(Curve(-1.0 * swing->amplitude_m, swing->amplitude_m), step_m);

    std::vector<Vec2> foci = modulation.foci_m;
    if (foci.empty()) foci.push_back({});
    std::vector<std::vector<Vec2>> lines;
    for (const Vec2 focus : foci) {
        lines.push_back(line);
        for (Vec2& point : lines.back())
            point = point + rest + focus;
    }
    return lines;
}

} // namespace shearwake
