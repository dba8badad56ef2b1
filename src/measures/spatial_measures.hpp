// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/units.hpp"
#include "base/vectors.hpp"
#include "base/view.hpp"
#include "measures/surface_sums.hpp"
#include "measures/window.hpp"
#include "problem/case/case.hpp"
#include "problem/load/load.hpp"

#include <span>
#include <string>
#include <vector>

namespace shearwake::measures {

/// Delivered impulse: integral of the force over time from 0 to until_s [N s], zero after the path
/// has ended. Gauss rule in at least 10000 steps, and 100 per period of the highest frequency
/// of the force (carrier included). The error is below 1e-5. With rounded phases or an iterated
/// hologram, the force fluctuates by about 1 % as an array is steered, and the error is about 1e-4.
double impulse_N_s(const Load& load, double until_s);

/// Fraction (0 to 1) of the square cell of side spacing_m centred on (x_m, y_m) that lies inside
/// the disc of this centre and radius: the exact area of their intersection over that of the cell.
/// Over all cells of a grid the fractions times spacing^2 add up to pi radius^2.
double disc_fraction(double x_m, double y_m, double spacing_m, Vec2 centre, double radius_m);

/// For each sample of the whole surface, row-major, the fraction of its cell within `reach_m` of
/// the lines: 1 or 0, or between them if the centre of the cell is less than half a spacing from
/// that distance. Not collective.
std::vector<double> shares_near(std::span<const std::vector<Vec2>> lines, double reach_m,
                                const Domain& domain);

/// Sharpness of a drawn shape: the fraction of the energy of the region, sum w E / sum E, within
/// reach_m of its lines. E is the time mean of u_z^2 on the whole surface. NaN if E is zero
/// everywhere. Not collective.
double sharpness(View2<const double> mean_u2, const Domain& domain, const Region& region,
                 std::span<const std::vector<Vec2>> lines, double reach_m);

// Measures of the area over which a displacement is spread, as numbers of samples; multiplied by
// spacing^2, they are areas that do not depend on the grid. All increase with spread. NaN: nothing
// has moved.

/// (sum u)^2 / sum u^2: the inverse participation ratio as the thesis defines it. In nearly
/// incompressible tissue sum u is almost 0 (volume is conserved): it measures compressibility
/// rather than spread.
inline double ipr(const SurfaceSums& sums) {
    return sums.u * sums.u / sums.u2;
}

/// (sum |u|)^2 / sum u^2: the participation of the absolute displacement.
inline double ipr_abs(const SurfaceSums& sums) {
    return sums.abs_u * sums.abs_u / sums.u2;
}

/// (sum u^2)^2 / sum u^4: the participation of the squared displacement.
inline double participation(const SurfaceSums& sums) {
    return sums.u2 * sums.u2 / sums.u4;
}

/// sum_t (sum u)^2 / sum_t sum u^2.
inline double ipr(const PeriodSums& sums) {
    return sums.u_squared / sums.u2;
}

/// sum_t (sum |u|)^2 / sum_t sum u^2.
inline double ipr_abs(const PeriodSums& sums) {
    return sums.abs_u_squared / sums.u2;
}

/// sum_t (sum u^2)^2 / sum_t sum u^4.
inline double participation(const PeriodSums& sums) {
    return sums.u2_squared / sums.u4;
}

/// eta = sum_focal w u^2 / sum u^2: the fraction of the squared displacement inside the focal disc.
/// Dimensionless, 0 to 1. NaN: nothing has moved.
inline double reconstruction_efficiency(const SurfaceSums& sums) {
    return sums.focal_u2 / sums.u2;
}

/// eta_period = sum_t sum_focal w u^2 / sum_t sum u^2.
inline double reconstruction_efficiency(const PeriodSums& sums) {
    return sums.focal_u2 / sums.u2;
}

/// Half-angle of a wake, or the reason why it could not be determined.
struct MachFit {
    double angle_deg = not_a_number;
    /// The largest deviation from the angle of separate fits to the near and the far half of either
    /// side: 0 for a straight and symmetric wedge.
    double residual_deg = not_a_number;
    int points = 0; // number of points of the front, on both sides, in the fits
    std::string reason;
    bool valid() const { return reason.empty(); }
};

/// Half-angle of the wake in one snapshot u (nx x ny, the whole domain) behind a focus that was
/// switched on time_since_start_s ago, on a surface at rest, and has since moved with this
/// velocity.
///
/// Along lines across the direction of motion, xi behind the focus, the largest |u| on each side is
/// the front (cubic interpolation, so any direction will do); a straight line with free intercept
/// is fitted to each side, robustly (Theil-Sen, then least squares without outliers), and the two
/// angles are averaged. Only the steady part counts: the circle of radius c_R t about the start
/// touches the front L = v t cos^2(theta) behind the focus, so xi runs from 3 FWHM to the smaller
/// of 0.8 L and L - 3 FWHM. Samples in the sponge are excluded.
///
/// Against asin(c_R / v) on exact wakes of a half-space (c_s 5 m/s, 6 to 12 m/s, 14 ms, 0.75 mm):
/// lossless 0.1 to 0.3 degrees below it at 2 and 3 mm FWHM, 0.2 to 0.6 at 6 mm (from 7 m/s on); a
/// viscosity of 1 Pa s bends the front and lowers the angle by 1 to 3 degrees. Amplitude modulation
/// interrupts the front; if no straight front remains, a reason is returned instead of an angle.
MachFit mach_angle(View2<const double> u, const Domain& domain, Vec2 focus_m, Vec2 velocity_m_s,
                   double rayleigh_speed_m_s, double fwhm_m, double time_since_start_s);

/// asin(wave speed / speed) [degrees]: the surface wake is a Rayleigh wake. NaN unless supersonic.
double mach_angle_theory_deg(double wave_speed_m_s, double speed_m_s);

} // namespace shearwake::measures
