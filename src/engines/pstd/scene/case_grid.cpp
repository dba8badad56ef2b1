// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scene/case_grid.hpp"

#include "problem/medium/material_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace shearwake::pstd {
namespace {

/// Density of a rigid base relative to the last layer; it then moves by a millionth of it.
constexpr double rigid_density = 1e6;
/// Number of points of the rigid base above the absorbing layer.
constexpr std::ptrdiff_t base_points = 2;
/// Number of empty points between the skin and the absorbing layer above, into which the load is
/// continued.
constexpr std::ptrdiff_t empty_points = 4;

double total_thickness_m(const Medium& medium) {
    double sum_m = 0.0;
    for (const Layer& layer : medium.layers)
        sum_m += layer.thickness_m;
    return sum_m;
}

/// Waves that travel downward must not be cut off while the focus acts.
double chosen_depth_m(const Case& c) {
    double lowest_m = total_thickness_m(c.scene.medium);
    const auto reach_down = [&](double z_m) { // unbounded bodies do not limit the depth
        if (std::isfinite(z_m)) lowest_m = std::max(lowest_m, z_m);
    };
    for (const Body& body : c.scene.medium.bodies)
        reach_down(bounds(body).high_m.z);
    if (c.scene.medium.map) reach_down(depths(*c.scene.medium.map).bottom_m);
    const double reach_m = 4.0 * fwhm_m(c.scene.load.footprint);
    return std::max(reach_m, lowest_m + 0.5 * reach_m);
}

/// Maximum compressional wave speed of a fluid, which has no shear waves: that of the layers. 0 if
/// no body is a fluid.
double fluid_limit_m_s(const Medium& medium, double c_p_over_c_s) {
    const bool fluid = std::any_of(medium.bodies.begin(), medium.bodies.end(), is_fluid);
    double limit_m_s = 0.0;
    for (const Layer& layer : medium.layers)
        if (fluid) limit_m_s = std::max(limit_m_s, c_p_over_c_s * layer.c_s_m_s);
    return limit_m_s;
}

NodeMaterial capped(const Material& m, double c_p_over_c_s, double fluid_m_s = 0.0) {
    NodeMaterial node;
    node.density_kg_m3 = m.density_kg_m3;
    node.c_s_m_s = std::sqrt(m.mu_Pa / m.density_kg_m3);
    node.c_p_m_s = std::min(std::sqrt((m.lambda_Pa + 2.0 * m.mu_Pa) / m.density_kg_m3),
                            std::max(c_p_over_c_s * node.c_s_m_s, fluid_m_s));
    node.eta_Pa_s = m.viscosity_Pa_s;
    return node;
}

/// A modulus of a laminate along and across its layers.
struct Moduli {
    double along, across;
};

/// The part of the difference of both moduli that acts on the shear strain between two axes.
double shear_share(Vec3 n, std::size_t a, std::size_t b) {
    const std::array<double, 3> square{n.x * n.x, n.y * n.y, n.z * n.z};
    return square[a] + square[b] - 4.0 * square[a] * square[b];
}

/// The mean of that part over the two strains without shear and change of volume.
double normal_share(Vec3 n) {
    return 1.0 - (std::pow(n.x, 4) + std::pow(n.y, 4) + std::pow(n.z, 4));
}

double reduced(Moduli m, double share) {
    return m.along - share * (m.along - m.across);
}

/// The layers and their inclusions in a cell, as a laminate.
struct Cell {
    double density_kg_m3 = 0.0, lambda_Pa = 0.0;
    Moduli mu_Pa{};
    double viscosity_Pa_s = 0.0; // along the layers
    Vec3 normal{};
};

/// The normal is that of the part, or of the layers, with the greatest contrast.
Cell cell_of(const Case& c, Vec3 centre_m, double d_m) {
    const double top_m = centre_m.z - 0.5 * d_m, bottom_m = centre_m.z + 0.5 * d_m;
    Cell sum;
    double layer_top_m = 0.0, per_mu = 0.0, per_layer = 0.0, greatest = 0.0;
    const auto& layers = c.scene.medium.layers;
    for (std::size_t l = 0; l < layers.size(); ++l) {
        const bool last = l + 1 == layers.size();
        const double layer_bottom_m = layer_top_m + layers[l].thickness_m;
        const double from_m = l == 0 ? top_m : std::max(top_m, layer_top_m);
        const double to_m = last ? bottom_m : std::min(bottom_m, layer_bottom_m);
        layer_top_m = layer_bottom_m;
        const double share = (to_m - from_m) / d_m;
        if (share < 1e-9) continue;
        const CellMaterial part =
            material_of_cell(c.scene.medium, l, {centre_m.x, centre_m.y, 0.5 * (from_m + to_m)},
                             {d_m, d_m, to_m - from_m});
        sum.density_kg_m3 += share * part.density_kg_m3;
        sum.lambda_Pa += share * part.lambda_Pa;
        sum.mu_Pa.along += share * part.mu_Pa;
        sum.viscosity_Pa_s += share * part.viscosity_Pa_s;
        per_mu += share / part.mu_across_Pa;
        per_layer += share / part.mu_Pa;
        if (const double contrast = share * (1.0 - part.mu_across_Pa / part.mu_Pa);
            part.is_laminate() && contrast >= greatest) {
            greatest = contrast;
            sum.normal = part.normal;
        }
    }
    sum.mu_Pa.across = 1.0 / per_mu;
    if (const double contrast = 1.0 - 1.0 / (per_layer * sum.mu_Pa.along);
        contrast > std::max(greatest, 1e-9)) // of the layers
        sum.normal = {0.0, 0.0, 1.0};
    else if (norm(sum.normal) == 0.0)
        sum.mu_Pa.across = sum.mu_Pa.along;
    return sum;
}

} // namespace

CaseGrid case_grid(const Case& c, const PstdOptions& options) {
    const double d_m = c.domain.spacing_m;
    const std::ptrdiff_t layer = options.absorbing_points;
    const double deepest_m =
        *std::max_element(c.measure.depths_m.begin(), c.measure.depths_m.end());
    const double clear_m = std::max(options.depth_m > 0.0 ? options.depth_m : chosen_depth_m(c),
                                    deepest_m + 2.0 * d_m);
    CaseGrid grid;
    grid.spacing_m = d_m;
    grid.clear = static_cast<std::ptrdiff_t>(std::ceil(clear_m / d_m - 1e-9));
    if (c.scene.medium.base == Base::rigid) {
        grid.levels =
            static_cast<std::ptrdiff_t>(std::ceil(total_thickness_m(c.scene.medium) / d_m - 1e-9));
        grid.clear = grid.levels + base_points;
    }
    grid.above = options.top == PstdTop::nothing ? empty_points : grid.clear;
    grid.surface = layer + grid.above;
    const std::ptrdiff_t nz = good_even_length(grid.surface + grid.clear + layer);
    grid.clear = nz - grid.surface - layer;
    if (c.scene.medium.base == Base::half_space) grid.levels = grid.clear;
    const std::ptrdiff_t around = options.edges == PstdEdges::absorbing ? layer : 0;
    const std::ptrdiff_t nx = good_even_length(c.domain.nx + 2 * around),
                         ny = good_even_length(c.domain.ny + 2 * around);
    grid.first_x = around;
    grid.first_y = around;
    grid.points = {nx, ny, nz};
    return grid;
}

Node CaseGrid::domain_point(const Domain& domain, const Node& node) const {
    return {std::clamp<std::ptrdiff_t>(node[0] - first_x, 0, domain.nx - 1),
            std::clamp<std::ptrdiff_t>(node[1] - first_y, 0, domain.ny - 1), node[2]};
}

PmlOptions absorbing_layer(const Case& c, const PstdOptions& options) {
    const std::ptrdiff_t layer = options.absorbing_points;
    const auto margin =
        static_cast<std::ptrdiff_t>(std::lround(c.domain.sponge_m / c.domain.spacing_m));
    const std::ptrdiff_t lateral = options.edges == PstdEdges::absorbing ? layer : margin;
    const double strength = options.absorbing_strength;
    PmlOptions pml;
    pml.points = {lateral, lateral, layer};
    pml.strength_1 = {lateral > 0 ? strength : 0.0, lateral > 0 ? strength : 0.0, strength};
    for (const Layer& l : c.scene.medium.layers)
        pml.reference_speed_m_s =
            std::max(pml.reference_speed_m_s, capped_material(l, options).c_p_m_s);
    return pml;
}

Vec3 CaseGrid::place_m(const Domain& domain, const Node& node, Vec3 offset) const {
    const Node point = domain_point(domain, node);
    return {domain.x_m(point[0]) + offset.x * spacing_m,
            domain.y_m(point[1]) + offset.y * spacing_m,
            node_depth_m(node[2]) + offset.z * spacing_m};
}

NodeMaterial material_at(const Case& c, const PstdOptions& options, const CaseGrid& grid,
                         Node node) {
    const double z_m = grid.node_depth_m(node[2]);
    if (z_m < 0.0 && options.top != PstdTop::continued) {
        if (options.top == PstdTop::fluid)
            return {options.fluid_density_kg_m3,
                    std::min(options.fluid_c_p_m_s,
                             options.c_p_over_c_s * c.scene.medium.layers.front().c_s_m_s)};
        return {.density_kg_m3 = c.scene.medium.layers.front().density_kg_m3, .empty = true};
    }
    if (c.scene.medium.base == Base::rigid && z_m > total_thickness_m(c.scene.medium)) {
        NodeMaterial base = capped_material(c.scene.medium.layers.back(), options);
        base.density_kg_m3 *= rigid_density;
        const double slower = 1.0 / std::sqrt(rigid_density); // of the same stiffness
        base.c_p_m_s *= slower;
        base.c_s_m_s *= slower;
        return base;
    }
    if (z_m < 0.0) return capped_material(c.scene.medium.layers.front(), options);
    const Cell cell = cell_of(c, grid.place_m(c.domain, node, {}), c.domain.spacing_m);
    const double share = normal_share(cell.normal);
    return capped(
        {cell.density_kg_m3, cell.lambda_Pa, reduced(cell.mu_Pa, share), cell.viscosity_Pa_s},
        options.c_p_over_c_s, fluid_limit_m_s(c.scene.medium, options.c_p_over_c_s));
}

StaggeredMaterial staggered_material(const Case& c, const PstdOptions& options,
                                     const CaseGrid& grid) {
    const Grid nodes{grid.points, {}, 0.0};
    const MaterialOfNode at_node = [=, &c](Node n) { return material_at(c, options, grid, n); };
    const double bottom_m = c.scene.medium.base == Base::rigid
                                ? total_thickness_m(c.scene.medium)
                                : std::numeric_limits<double>::infinity();
    const auto within = [=](Node node, double above) {
        return grid.node_depth_m(node[2]) > 0.0 &&
               grid.node_depth_m(node[2]) + above * grid.spacing_m < bottom_m;
    };
    const auto cell = [=, &c](Node node, Vec3 offset) {
        return cell_of(c, grid.place_m(c.domain, node, offset), grid.spacing_m);
    };
    constexpr std::array<Vec3, 3> half{Vec3{0.5, 0, 0}, Vec3{0, 0.5, 0}, Vec3{0, 0, 0.5}};
    StaggeredMaterial all;
    for (std::size_t a = 0; a < 3; ++a) {
        all.density_kg_m3[a] = [=](Node n) {
            return within(n, 2.0 * half[a].z) ? cell(n, half[a]).density_kg_m3
                                              : density_between(nodes, at_node, n, a);
        };
        const std::size_t i = a < 2 ? 0 : 1, j = a < 1 ? 1 : 2; // of sxy, sxz, syz
        all.mu_Pa[a] = [=](Node n) {
            if (!within(n, 2.0 * (half[i] + half[j]).z))
                return harmonic_between(
                    nodes, [&](Node m) { return at_node(m).mu_Pa(); }, n, i, j);
            const Cell m = cell(n, half[i] + half[j]);
            return reduced(m.mu_Pa, shear_share(m.normal, i, j));
        };
    }
    return all;
}

NodeMaterial capped_material(const Layer& layer, const PstdOptions& options) {
    return capped(material_of(layer), options.c_p_over_c_s);
}

bool is_lossy(const Medium& medium) {
    const auto viscous = [](const auto& of) { return of.viscosity_Pa_s.value_or(0.0) > 0.0; };
    bool lossy = medium.map != nullptr && !medium.map->viscosity_Pa_s.empty();
    for (const Layer& layer : medium.layers)
        lossy = lossy || material_of(layer).viscosity_Pa_s > 0.0;
    return lossy || std::any_of(medium.bodies.begin(), medium.bodies.end(), viscous);
}

} // namespace shearwake::pstd
