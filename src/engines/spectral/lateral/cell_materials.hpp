// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/spectral/lateral/strain_transfer.hpp"
#include "problem/medium/material_field.hpp"

#include <vector>

namespace shearwake::spectral {

/// The depth range that a node represents: the cell that corresponds to its quadrature weight.
struct DepthCell {
    double centre_m, size_m;
};
/// Not collective.
DepthCell depth_cell(const DepthMesh& mesh, std::size_t element, std::size_t node);

/// Whether all bodies have smooth edges. Sharp bodies are averaged over cells; smooth ones are
/// sampled at points, which converges spectrally.
bool is_smooth(const Medium& medium);

/// Reflected share of the amplitude of a shear wave at normal incidence on a plane interface, from
/// the impedances sqrt(mu rho). Both ratios are those behind the interface over those in front of
/// it.
double shear_reflection(double stiffness_ratio, double density_ratio);

/// The material with which the engine represents an inclusion: its shear stiffness is capped at
/// `contrast_cap` times that of the layer.
class CappedMaterials {
public:
    CappedMaterials(const Case& c, const Material& layer);
    Material operator()(Material m) const;

private:
    double most_mu_Pa_;
};

/// Materials at one strain point for the rows of this rank, [row][ny]. Not collective.
std::vector<Material> cell_materials(const Case& c, const DepthMesh& mesh,
                                     const fft::SlabShare& share, const StrainPoint& point);
/// Materials at a depth within an element: sampled at this depth for smooth bodies, otherwise those
/// of the node's cell. Not collective.
std::vector<Material> cell_materials(const Case& c, const DepthMesh& mesh,
                                     const fft::SlabShare& share, std::size_t element,
                                     double depth_m);

} // namespace shearwake::spectral
