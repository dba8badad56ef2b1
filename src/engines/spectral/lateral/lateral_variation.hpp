// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/depth/vertical_operator.hpp"
#include "engines/spectral/lateral/cell_materials.hpp"
#include "engines/spectral/lateral/strain_transfer.hpp"
#include "parallel/comm.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace shearwake::spectral {

/// Compressional stiffnesses within this ratio share one stabilising modulus, the largest.
constexpr double one_lambda = 1.5;
/// Tolerated inertia, relative to that of the soft tissue, that one background solve per step may
/// add at the wavenumber where the spectrum of the footprint has fallen to a half. If the step is
/// chosen from the accuracy, this error stays well below the accuracy.
inline double tolerated_inertia(const SpectralOptions& options) {
    return options.time_step_s ? 0.02 : std::min(0.02, 0.3 * options.accuracy);
}

/// The laterally varying part of the medium on this rank's rows: at each strain point the affected
/// cells and their moduli in addition to those of the background's forces, times the quadrature
/// weight [m]. The implicit operator is
///     background + E^T (implicit) E,   with the strain (and, for density, displacement) E,
/// where the implicit moduli are never negative.
struct LateralVariation {
    using Point = PlaneCells::Point;
    /// A cell that the surface of a body crosses: the moduli for shear across the surface are lower
    /// than the others by these, times the quadrature weight.
    struct Surface {
        std::size_t cell; // within the point
        Vec3 normal;
        double mu, viscosity, implicit_mu;
    };
    std::vector<StrainPoint> strain_points;
    std::vector<Point> points;
    std::vector<std::vector<Surface>> surfaces; // of each point
    std::size_t cells = 0;
    std::vector<double> lambda, mu, viscosity;                       // of the forces, per cell
    std::vector<double> implicit_lambda, implicit_mu, implicit_mass; // empty without iterations
    Background background;
    bool iterates = false;
    bool density_varies = false;
    std::string why; // it iterates or does not

    bool empty() const { return strain_points.empty(); }
    int components() const { return density_varies ? all_components : strain_components; }
};

/// The magnitude of the largest wave vector of a grid.
double largest_k_rad_m(const Domain& domain);

/// Collects the varying cells; the extremes over the complete plane determine the solution method.
/// `k_max_rad_m`: the magnitude of the largest wave vector. Throws CaseFailure on all ranks
/// together. Collective over `team`; null: this rank has all rows.
LateralVariation lateral_variation(const Case& c, const DepthMesh& mesh,
                                   const fft::SlabShare& share, double k_max_rad_m, double step_s,
                                   const Comm* team);

} // namespace shearwake::spectral
