#pragma once

#include "engines/pstd/material.hpp"
#include "engines/pstd/pml.hpp"
#include "model/case.hpp"

namespace shearwake::pstd {

/// Where a case lies on the grid. u_z of storage index (first_x + i, first_y + j, surface - 1)
/// stands at the domain's point (i, j) and at z = 0, the node `surface` half a spacing below it.
struct CaseGrid {
    std::array<std::ptrdiff_t, 3> points = {};
    std::ptrdiff_t first_x = 0, first_y = 0; // points of the layer around the domain
    std::ptrdiff_t surface = 0;
    std::ptrdiff_t clear = 0;  // points below the surface that do not absorb
    std::ptrdiff_t above = 0;  // and above it
    std::ptrdiff_t levels = 0; // planes of u_z from z = 0 on that are in the medium
    double spacing_m = 0.0;

    double node_depth_m(std::ptrdiff_t z) const {
        return (static_cast<double>(z - surface) + 0.5) * spacing_m;
    }
};
CaseGrid case_grid(const Case& c, const PstdOptions& options);

/// The absorbing layer: around the domain in z; in x and y around it, or in its margin of
/// domain.sponge_m, or nowhere. Its reference speed is the fastest of the layers, as held.
PmlOptions absorbing_layer(const Case& c, const PstdOptions& options);

/// What the case has at a node, compressional waves held to `c_p_over_c_s` times the shear waves; a
/// cell that lies in several layers has their mean by volume. Below a rigid base matter that is too
/// heavy to move. Beyond the domain in x and y what is at its edge.
NodeMaterial material_at(const Case& c, const PstdOptions& options, const CaseGrid& grid,
                         Node node);

/// A layer's own material, held likewise.
NodeMaterial held_material(const Layer& layer, const PstdOptions& options);

bool is_lossy(const Medium& medium);

} // namespace shearwake::pstd
