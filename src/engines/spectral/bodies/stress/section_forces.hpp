// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/stress/grid_forces.hpp"

#include <vector>

namespace shearwake::spectral {

/// The static stress [Pa] at `r_m` from a force per length [N/m] on a line along y, in a solid
/// without boundaries with this ratio lambda/mu: plane strain, and shear along y.
Stress line_stress(Vec3 r_m, double lambda_per_mu, Vec3 force_N_m);

/// The same for a marker of a body along y, as the engine computes it: with the elements of a mesh
/// over depth, the wavenumbers across the axis that the grid resolves, and the smoothing of the
/// marker. Not collective.
class SectionForces {
public:
    /// Largest distance in depth of a force and a stress, in spacings.
    static constexpr double reach = 9.0;

    /// For forces at `force_m` and stresses at `stress_m`, both depths.
    SectionForces(const DepthMesh& mesh, double spacing_m, double lambda_per_mu,
                  const std::vector<double>& force_m, const std::vector<double>& stress_m);

    /// The stress [1/m] for unit forces at a distance across the axis; zero beyond `reach`.
    ForceStress at(std::size_t stress_depth, std::size_t force_depth, double across_m) const;
    /// Memory for so many depths of forces and of stresses, in bytes.
    static double memory_B(double forces, double stresses);

private:
    std::size_t forces_;
    double spacing_m_;
    std::vector<double> weights_;     // of the sum over the wavenumbers [1/m]
    std::vector<RadialStress> waves_; // [stress depth][force depth][wavenumber]
};

} // namespace shearwake::spectral
