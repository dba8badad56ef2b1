// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/material.hpp"
#include "engines/pstd/scheme/pml.hpp"
#include "problem/case/case.hpp"

namespace shearwake::pstd {

/// Position of a case on the grid. u_z of the storage index (first_x + i, first_y + j, surface - 1)
/// is at the point (i, j) of the domain and at z = 0; the node `surface` is half a spacing below.
struct CaseGrid {
    std::array<std::ptrdiff_t, 3> points = {};
    std::ptrdiff_t first_x = 0, first_y = 0; // points of the absorbing layer around the domain
    std::ptrdiff_t surface = 0;
    std::ptrdiff_t clear = 0;  // points below the surface that do not absorb
    std::ptrdiff_t above = 0;  // points above the surface that do not absorb
    std::ptrdiff_t levels = 0; // planes of u_z within the medium, beginning at z = 0
    double spacing_m = 0.0;

    double node_depth_m(std::ptrdiff_t z) const {
        return (static_cast<double>(z - surface) + 0.5) * spacing_m;
    }
    /// The point (i, j) of the domain nearest to a node.
    Node domain_point(const Domain& domain, const Node& node) const;
    /// A place near that point, at an offset in spacings.
    Vec3 place_m(const Domain& domain, const Node& node, Vec3 offset) const;
};
/// Chooses the grid of a case. Not collective.
CaseGrid case_grid(const Case& c, const PstdOptions& options);

/// The absorbing layer: around the domain in z; in x and y around the domain, in its margin
/// domain.sponge_m, or absent. Its reference speed is the largest capped c_p of the layers.
PmlOptions absorbing_layer(const Case& c, const PstdOptions& options);

/// The material at a node, with c_p capped at `c_p_over_c_s` times c_s. The layers and bodies in a
/// cell form a laminate, of which the node has the modulus of the strains along its axes, averaged
/// over those of constant volume. A rigid base is represented by a density that is too high to
/// move. Outside of the domain in x and y the material at the edge applies. Not collective.
NodeMaterial material_at(const Case& c, const PstdOptions& options, const CaseGrid& grid,
                         Node node);

/// The material at the staggered points: density and shear modulus of the laminate in the cell
/// around each one (Kristek et al. 2017, without its orthorhombic normal stresses), harmonic means
/// of the viscosity of nodes. Means of nodes apply at the skin and the rigid base. Not collective.
StaggeredMaterial staggered_material(const Case& c, const PstdOptions& options,
                                     const CaseGrid& grid);

/// The material of a layer with its capped c_p.
NodeMaterial capped_material(const Layer& layer, const PstdOptions& options);

/// Whether a layer, a body or the map has viscosity.
bool is_lossy(const Medium& medium);

} // namespace shearwake::pstd
