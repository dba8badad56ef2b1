// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/section_markers.hpp"

#include "base/error.hpp"
#include "problem/medium/material_field.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake::spectral {
namespace {

/// SectionSpacings of the grid and of the levels.
struct SectionSpacings {
    double across_m, down_m;
};

/// Adds a point and its mirror images.
void add_mirrored(double across_m, double down_m, std::vector<SectionMarker>& markers) {
    markers.push_back({across_m, down_m});
    if (across_m != 0.0) markers.push_back({-across_m, down_m});
    if (down_m != 0.0) markers.push_back({across_m, -down_m});
    if (across_m != 0.0 && down_m != 0.0) markers.push_back({-across_m, -down_m});
}

/// Markers at equal distances in units of the spacings, half of one from the axes of symmetry.
std::vector<SectionMarker> on_circle(double radius_m, const SectionSpacings& h) {
    std::vector<SectionMarker> markers;
    for (const double angle : // from the vertical
         quarter_angles(radius_m / h.across_m, radius_m / h.down_m, marker_spacing, 4000)) {
        const double across = std::sin(angle), down = std::cos(angle);
        const double inner_m = radius_m - curved_inset * h.across_m * across;
        add_mirrored(inner_m * across, inner_m * down, markers);
    }
    return markers;
}

std::vector<SectionMarker> on_rectangle(double half_across_m, double half_down_m,
                                        const SectionSpacings& h) {
    const double inner_m = half_across_m - flat_inset * h.across_m;
    const auto parts_of = [](double length, double spacing) {
        return std::max(1L, std::lround(length / (marker_spacing * spacing)));
    };
    std::vector<SectionMarker> markers;
    const auto at = [](double half_m, long i, long count) {
        return half_m * (2.0 * static_cast<double>(i) / static_cast<double>(count) - 1.0);
    };
    const long wide = parts_of(2.0 * inner_m, h.across_m),
               high = parts_of(2.0 * half_down_m, h.down_m);
    for (long i = 0; 2 * i <= wide; ++i)
        add_mirrored(at(inner_m, i, wide), half_down_m, markers);
    for (long i = 1; 2 * i <= high; ++i)
        add_mirrored(inner_m, at(half_down_m, i, high), markers);
    return markers;
}

/// Adds markers between the outermost ones at every second depth.
void fill_inside(const SectionSpacings& h, std::vector<SectionMarker>& markers) {
    std::vector<SectionMarker> inside;
    std::size_t depth = 0;
    for (std::size_t begin = 0, end; begin < markers.size(); begin = end, ++depth) {
        for (end = begin; end < markers.size() && markers[end].down_m == markers[begin].down_m;)
            ++end;
        const double half_m = std::abs(markers[begin].across_m);
        const auto gaps = std::lround(2.0 * half_m / (inner_spacing * h.across_m));
        if (end - begin > 2 || depth % 2 == 0 || gaps < 2) continue;
        for (long i = 1; i < gaps; ++i)
            inside.push_back(
                {half_m * (2.0 * static_cast<double>(i) / static_cast<double>(gaps) - 1.0),
                 markers[begin].down_m});
    }
    markers.insert(markers.end(), inside.begin(), inside.end());
}

void sort_by_depth(std::vector<SectionMarker>& markers) {
    std::sort(markers.begin(), markers.end(), [](const auto& a, const auto& b) {
        return a.down_m != b.down_m ? a.down_m < b.down_m : a.across_m < b.across_m;
    });
}

} // namespace

std::vector<double> quarter_angles(double a, double b, double spacing, int steps) {
    const double step = 0.5 * std::numbers::pi / steps;
    std::vector<double> length(static_cast<std::size_t>(steps) + 1, 0.0);
    for (int i = 0; i < steps; ++i) {
        const double angle = (i + 0.5) * step;
        length[static_cast<std::size_t>(i) + 1] =
            length[static_cast<std::size_t>(i)] +
            step * std::hypot(a * std::cos(angle), b * std::sin(angle));
    }
    const auto count = std::max(1L, std::lround(length.back() / spacing));
    std::vector<double> angles;
    for (long n = 0; n < count; ++n) {
        const double at =
            length.back() * (static_cast<double>(n) + 0.5) / static_cast<double>(count);
        const auto above = std::lower_bound(length.begin() + 1, length.end() - 1, at);
        const double share = (at - above[-1]) / (above[0] - above[-1]);
        angles.push_back((static_cast<double>(above - length.begin()) - 1.0 + share) * step);
    }
    return angles;
}

CrossSection cross_section(const Body& body, Endless along) {
    return std::visit(
        overloaded{[](const Ellipsoid&) -> CrossSection { throw Error("an endless ellipsoid"); },
                   [](const Cylinder& cylinder) {
                       return CrossSection{true, cylinder.radius_m, cylinder.radius_m};
                   },
                   [&](const Box& box) {
                       const Vec3 size_m = box.size_m;
                       return CrossSection{false,
                                           0.5 * (along == Endless::along_x ? size_m.y : size_m.x),
                                           0.5 * size_m.z};
                   }},
        body.shape);
}

std::vector<SectionMarker> section_markers(const Body& body, Endless along, double spacing_m,
                                           double spacing_z_m) {
    const SectionSpacings h{spacing_m, spacing_z_m};
    const CrossSection section = cross_section(body, along);
    std::vector<SectionMarker> markers =
        section.is_round ? on_circle(section.half_down_m, h)
                         : on_rectangle(section.half_across_m, section.half_down_m, h);
    sort_by_depth(markers);
    fill_inside(h, markers);
    sort_by_depth(markers);
    return markers;
}

double level_spacing_m(const DepthMesh& mesh, double top_m, double bottom_m) {
    double widest = 0.0, spacing_m = 0.0;
    for (std::size_t i = 1; i < mesh.rule.nodes.size(); ++i)
        widest = std::max(widest, 0.5 * (mesh.rule.nodes[i] - mesh.rule.nodes[i - 1]));
    // Elements end at bodies; rounding does not make the next one belong to a body.
    const double margin_m = 1e-6 * (bottom_m - top_m);
    for (std::size_t e = 0; e < mesh.elements(); ++e)
        if (mesh.ends_m[e] < bottom_m - margin_m && mesh.ends_m[e + 1] > top_m + margin_m)
            spacing_m = std::max(spacing_m, widest * mesh.length_m(e));
    return spacing_m;
}

double density_at(const Medium& medium, double depth_m) {
    for (std::size_t i = 0; i + 1 < medium.layers.size(); ++i)
        if (depth_m < depths(medium, i).bottom_m) return medium.layers[i].density_kg_m3;
    return medium.layers.back().density_kg_m3;
}

SectionMass excess_mass(const Body& body, Endless along, const Medium& medium) {
    constexpr int samples = 160;
    const bool along_x = along == Endless::along_x;
    const Bounds box = bounds(body);
    const double low_m = along_x ? box.low_m.y : box.low_m.x;
    const double wide_m = ((along_x ? box.high_m.y : box.high_m.x) - low_m) / samples;
    const double high_m = (box.high_m.z - box.low_m.z) / samples;
    SectionMass mass{};
    for (int i = 0; i < samples; ++i) {
        for (int j = 0; j < samples; ++j) {
            const double at_m = low_m + (i + 0.5) * wide_m;
            const double z_m = box.low_m.z + (j + 0.5) * high_m;
            const Vec3 place =
                along_x ? Vec3{body.centre_m.x, at_m, z_m} : Vec3{at_m, body.centre_m.y, z_m};
            const Vec3 cell = along_x ? Vec3{0.0, wide_m, high_m} : Vec3{wide_m, 0.0, high_m};
            const double around = density_at(medium, z_m);
            const double more = (body.density_kg_m3.value_or(around) - around) * wide_m * high_m *
                                volume_fraction(body, place, cell);
            const double across = at_m - (along_x ? body.centre_m.y : body.centre_m.x);
            const double deep = z_m - body.centre_m.z;
            // Motion (along, across, down) of this point for each degree of freedom.
            const double moves[section_freedoms][3] = {
                {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, deep, -across}};
            for (std::size_t a = 0; a < section_freedoms; ++a)
                for (std::size_t b = 0; b < section_freedoms; ++b)
                    for (int k = 0; k < 3; ++k)
                        mass[a * section_freedoms + b] += more * moves[a][k] * moves[b][k];
        }
    }
    return mass;
}

} // namespace shearwake::spectral
