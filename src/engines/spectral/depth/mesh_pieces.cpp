// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/depth/mesh_pieces.hpp"

#include "base/units.hpp"
#include "problem/case/edges.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::spectral {

namespace {

/// Largest length of elements of degree 8 at a rigid or a curved body, in grid spacings: levels are
/// then at most 1.3 spacings apart. Where the markers of a rigid body were 1.8 or 2.5 spacings
/// apart in z, its effect on the surface changed by 2 or 5 %; the effect of a curved elastic body
/// does not converge with the spacing unless the elements become shorter as well.
constexpr double spacings_of_curved = 7.0;

/// An inclusion in the layers between two depths.
struct Inclusion {
    double top_m, bottom_m, longest_m;
    bool ends_sharply;
    /// Density of a rigid body that is free to move.
    double free_kg_m3 = std::numeric_limits<double>::infinity();
};

/// Whether the body has faces that are neither horizontal nor vertical.
bool is_curved(const Body& body) {
    const auto is_level = [](Vec3 axis) { return axis.z == 0.0 || std::abs(axis.z) == 1.0; };
    const BodyAxes axes = axes_of(body);
    const auto is_round = [&](const Cylinder& cylinder) {
        return cylinder.axis != CylinderAxis::vertical && std::abs(axes.x.z) != 1.0;
    };
    const auto is_tilted = [&](const Box&) {
        return !(is_level(axes.x) && is_level(axes.y) && is_level(axes.z));
    };
    return std::visit(overloaded{[](const Ellipsoid&) { return true; }, is_round, is_tilted},
                      body.shape);
}

Inclusion inclusion_of(const Body& body, double spacing_m, double per_degree, double omega_rad_s) {
    const Bounds box = bounds(body);
    Inclusion in{box.low_m.z, box.high_m.z, std::numeric_limits<double>::infinity(),
                 !(body.edge_m > 0.0)};
    if (body.edge_m > 0.0)
        in.longest_m = per_degree * body.edge_m;
    else if (is_curved(body))
        in.longest_m = per_degree * std::min((in.bottom_m - in.top_m) / elements_of_body,
                                             spacings_of_curved * spacing_m);
    if (body.rigid && !body.fixed && body.density_kg_m3) in.free_kg_m3 = *body.density_kg_m3;
    if (body.rigid)
        in.longest_m = std::min(in.longest_m, spacings_of_curved * per_degree * spacing_m);
    else if (body.c_s_m_s)
        in.longest_m =
            std::min(in.longest_m, 20.0 * per_degree * *body.c_s_m_s / std::max(omega_rad_s, 1.0));
    return in;
}

Inclusion inclusion_of(const MaterialMap& map, double per_degree) {
    constexpr double endless_m = 1e9;
    if (!(map.spacing_m.z > 0.0))
        return {-endless_m, endless_m, std::numeric_limits<double>::infinity(), false};
    const double half_m = 0.5 * map.spacing_m.z;
    const double last_m = map.origin_m.z + map.spacing_m.z * static_cast<double>(map.counts[2] - 1);
    return {map.origin_m.z - half_m, last_m + half_m, 8.0 * per_degree * map.spacing_m.z, true};
}

} // namespace

std::vector<MeshPiece> mesh_pieces(const Case& c, double depth_m, double least_m, int degree,
                                   double omega_rad_s) {
    const double per_degree = degree / 8.0;
    std::vector<Inclusion> inclusions;
    for (const Body& body : c.scene.medium.bodies)
        inclusions.push_back(inclusion_of(body, c.domain.spacing_m, per_degree, omega_rad_s));
    if (c.scene.medium.map) inclusions.push_back(inclusion_of(*c.scene.medium.map, per_degree));

    std::vector<MeshPiece> pieces;
    double top_m = 0.0;
    for (std::size_t l = 0; l < c.scene.medium.layers.size(); ++l) {
        const bool last = l + 1 == c.scene.medium.layers.size();
        const double bottom_m = last ? depth_m : top_m + c.scene.medium.layers[l].thickness_m;
        std::vector<double> cuts_m;
        for (const Inclusion& in : inclusions)
            if (in.ends_sharply) cuts_m.insert(cuts_m.end(), {in.top_m, in.bottom_m});
        std::sort(cuts_m.begin(), cuts_m.end());
        std::vector<double> ends_m = {top_m};
        for (const double cut_m : cuts_m)
            if (cut_m - ends_m.back() > least_m && bottom_m - cut_m > least_m)
                ends_m.push_back(cut_m);
        ends_m.push_back(bottom_m);
        for (std::size_t i = 0; i + 1 < ends_m.size(); ++i) {
            MeshPiece piece{l, ends_m[i], ends_m[i + 1]};
            for (const Inclusion& in : inclusions)
                if (in.top_m < piece.bottom_m - least_m && in.bottom_m > piece.top_m + least_m) {
                    piece.longest_m = std::min(piece.longest_m, in.longest_m);
                    piece.has_light_body |= in.free_kg_m3 < c.scene.medium.layers[l].density_kg_m3;
                }
            pieces.push_back(piece);
        }
        top_m = bottom_m;
    }
    return pieces;
}

namespace {

/// The slow motion with the longest lateral period, e^{-kz} with k = 2 pi/extent, has rotation that
/// only distance attenuates: it returns as e^{-2 k depth} = 4e-5. At 0.55 the error of the surface
/// field is ten times as large.
constexpr double depth_per_extent = 0.8;

/// The greatest depth of a measurement, body or map.
double deepest_m(const Case& c) {
    double deepest = 0.0;
    const auto reach = [&](double z_m) {
        if (std::isfinite(z_m)) deepest = std::max(deepest, z_m);
    };
    for (const auto& depths_m : {c.measure.depths_m, stress_depths_m(c)})
        for (const double z_m : depths_m)
            reach(z_m);
    for (const Body& body : c.scene.medium.bodies)
        reach(bounds(body).high_m.z);
    if (c.scene.medium.map) reach(depths(*c.scene.medium.map).bottom_m);
    return deepest;
}

} // namespace

AbsorbingBottom absorbing_bottom(const Case& c, const SpectralOptions& options) {
    double interface_m = 0.0;
    for (const Layer& layer : c.scene.medium.layers)
        interface_m += layer.thickness_m;
    const double width_m = fwhm_m(c.scene.load.footprint);
    AbsorbingBottom bottom;
    bottom.longest_m = longest_wave_m(c.scene.load, c.scene.medium.layers.back().c_s_m_s);
    bottom.clear_m = std::max(
        {0.5 * bottom.longest_m - interface_m, deepest_m(c) + width_m - interface_m, width_m});
    bottom.depth_m =
        options.absorbing_depth_m > 0.0
            ? options.absorbing_depth_m
            : std::max(depth_per_extent * std::max(c.domain.extent_x_m(), c.domain.extent_y_m()),
                       1.5 * bottom.longest_m);
    return bottom;
}

double swirl_viscosity_Pa_s(const AbsorbingBottom& bottom, const Layer& layer, double into_m) {
    const double waves = two_pi * bottom.depth_m / bottom.longest_m;
    const double share = into_m / bottom.depth_m;
    return 45.0 / (waves * waves) * layer.density_kg_m3 * layer.c_s_m_s * bottom.depth_m *
           std::pow(share, 4);
}

} // namespace shearwake::spectral
