// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/stress/static_response.hpp"
#include "engines/spectral/kernels/transfer.hpp"
#include "problem/medium/material_field.hpp"

#include <array>
#include <vector>

namespace shearwake::spectral {

/// A stress tensor, ordered as xx, yy, zz, yz, xz, xy.
using Stress = std::array<double, strain_components>;
/// The stresses due to unit forces along x, y and z.
using ForceStress = std::array<Stress, 3>;

/// Kelvin's solution: the static stress [1/m^2] at `r_m` from unit forces in a solid without
/// boundaries with this ratio lambda/mu.
ForceStress kelvin_stress(Vec3 r_m, double lambda_per_mu);
/// The same [Pa] from a force [N].
Stress kelvin_stress(Vec3 r_m, double lambda_per_mu, Vec3 force_N);

/// Kelvin's solution for a force that acts on one point of the grid, as the engine computes it:
/// with the elements of a mesh over depth and the wave vectors that the grid resolves, the pressure
/// smoothed over depth as at receptors. The field of a point force contains all wave vectors;
/// without the others it alternates from point to point near the force, as it does from node to
/// node of an element. The elements continue above the surface and below the base, and the solid is
/// the same everywhere. Not collective.
class GridForces {
public:
    /// Largest lateral distance of a force and of a point, in spacings, and the largest distance
    /// in depth.
    static constexpr std::ptrdiff_t reach = 9;

    /// For forces at `force_m` and stresses at `stress_m`, both depths.
    GridForces(const DepthMesh& mesh, double spacing_m, double lambda_per_mu,
               const std::vector<double>& force_m, const std::vector<double>& stress_m);

    /// The stress [1/m^2] at a point (x, y) spacings from the force; zero beyond `reach`.
    ForceStress at(std::size_t stress_depth, std::size_t force_depth, std::ptrdiff_t x,
                   std::ptrdiff_t y) const;
    /// Memory for these numbers of depths of forces and of stresses, in bytes.
    static double memory_B(double forces, double stresses) {
        return sizeof(double) * static_cast<double>(per_pair) * forces * stresses;
    }

private:
    static constexpr std::ptrdiff_t side = reach + 1;
    static constexpr std::size_t per_pair =
        2 * strain_components * static_cast<std::size_t>(side * side);
    double* values(std::size_t stress_depth, std::size_t force_depth) {
        return values_.data() + (stress_depth * forces_ + force_depth) * per_pair;
    }
    void add(const RadialStress& f, std::ptrdiff_t kx, std::ptrdiff_t ky, double* values) const;

    std::size_t forces_;
    double spacing_m_;
    std::vector<double> cosine_, sine_; // [wavenumber][distance]
    /// [stress depth][force depth][force along x or z][component][x][y]
    std::vector<double> values_;
};

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
    /// Memory for these numbers of depths of forces and of stresses, in bytes.
    static double memory_B(double forces, double stresses);

private:
    std::size_t forces_;
    double spacing_m_;
    std::vector<double> weights_;     // of the sum over the wavenumbers [1/m]
    std::vector<RadialStress> waves_; // [stress depth][force depth][wavenumber]
};

} // namespace shearwake::spectral
