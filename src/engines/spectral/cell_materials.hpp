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

/// What a stiff body loses less than the layer around it is not seen while it is less than this
/// share of its own stiffness, at the frequency that the footprint shakes it with.
constexpr double unseen_loss = 0.01;

/// Of the amplitude of a shear wave that meets a plane face head on, by impedances sqrt(mu rho);
/// both ratios are of what lies behind it over what lies before it.
double shear_reflection(double stiffness_ratio, double density_ratio);

/// What the engine computes with in a body's place: no stiffer in shear than `contrast_cap` times
/// the layer, and as viscous as the layer where that is not seen. A background without viscosity
/// would make all cells of the plane iterate.
class HeldMaterials {
public:
    HeldMaterials(const Case& c, const Material& layer);
    Material operator()(Material m) const;

private:
    double most_mu_Pa_, layer_viscosity_Pa_s_, omega_rad_s_;
};

/// Materials of one strain point over this rank's rows, row by row of ny.
std::vector<Material> cell_materials(const Case& c, const DepthMesh& mesh, const SlabShare& share,
                                     const StrainPoint& point);
/// The same at a depth within an element: of smooth bodies right there, else of its node's cell.
std::vector<Material> cell_materials(const Case& c, const DepthMesh& mesh, const SlabShare& share,
                                     std::size_t element, double depth_m);

} // namespace shearwake
