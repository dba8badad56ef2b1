#pragma once

#include "engines/spectral/depth_mesh.hpp"
#include "engines/spectral/strain_transfer.hpp"
#include "model/material_field.hpp"

#include <vector>

namespace shearwake {

/// A node's share of its element's depth: the cell that its quadrature weight stands for.
struct DepthCell {
    double centre_m, size_m;
};
DepthCell depth_cell(const DepthMesh& mesh, std::size_t element, std::size_t node);

/// Sharp bodies are averaged over cells; smooth ones are sampled, which converges spectrally.
bool is_smooth(const Medium& medium);

/// Materials of one strain point over this rank's rows, row by row of ny.
std::vector<Material> cell_materials(const Case& c, const DepthMesh& mesh, const SlabShare& share,
                                     const StrainPoint& point);

} // namespace shearwake
