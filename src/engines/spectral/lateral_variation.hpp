#pragma once

#include "engines/spectral/strain_transfer.hpp"
#include "engines/spectral/vertical_operator.hpp"
#include "fft/run_transform.hpp"
#include "parallel/comm.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace shearwake {

/// Compressional stiffnesses that differ less than this share one stabilising modulus: the largest.
constexpr double one_lambda = 1.5;
/// The added inertia, relative to the soft tissue's, that one background solve a step may cost at
/// the wavenumber where the footprint's spectrum has fallen to a half. A step chosen from the
/// accuracy may not lose it to that.
inline double tolerated_inertia(const SpectralOptions& options) {
    return options.time_step_s ? 0.02 : std::min(0.02, 0.3 * options.accuracy);
}

/// What varies laterally, on this rank's rows: at each strain point the cells concerned, and their
/// moduli beyond those of the background's forces, times the quadrature weight [m]. The implicit
/// operator is
///     background + E^T (implicit) E,   E the strain (and displacement, for density),
/// where the implicit ones are never negative.
struct LateralVariation {
    struct Point {
        std::vector<RowRun> runs;
        std::size_t first = 0, cells = 0;
    };
    std::vector<StrainPoint> strain_points;
    std::vector<Point> points;
    std::size_t cells = 0;
    std::vector<double> lambda, mu, viscosity;                       // of the forces, per cell
    std::vector<double> implicit_lambda, implicit_mu, implicit_mass; // empty without iterations
    Background background;
    bool iterates = false;
    bool density_varies = false;
    std::vector<std::string> notes;

    bool empty() const { return strain_points.empty(); }
    int components() const { return density_varies ? all_components : strain_components; }
};

/// Collective: extremes over the whole plane decide. Throws CaseFailure on all ranks together.
LateralVariation lateral_variation(const Case& c, const DepthMesh& mesh, const WaveVectors& vectors,
                                   double step_s, const Comm& team);

} // namespace shearwake
