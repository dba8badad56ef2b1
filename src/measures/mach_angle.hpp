// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/units.hpp"
#include "base/vectors.hpp"
#include "base/view.hpp"
#include "problem/case/case.hpp"

#include <string>

namespace shearwake::measures {

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
