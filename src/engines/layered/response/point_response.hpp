// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/layered/response/bessel_blocks.hpp"

#include <complex>
#include <functional>
#include <span>
#include <vector>

namespace shearwake::layered {

// The response of an infinite plane to a point load at one frequency, see
// docs/explanation/engine-layered.md ("Open edges"):
//
//     g(r) = 1/(2 pi) integral_0^inf H(k) low_pass(k) J0(k r) k dk.
//
// The low-pass filter removes wavenumbers above pi / spacing, so that g can be sampled on the grid.
// The remainder H (1 - low_pass) contains no waves that travel across the grid and is treated as
// periodic.

/// exp(-(k / k0)^16) with k0 such that it is 1e-10 at pi / spacing.
std::complex<double> low_pass(std::complex<double> k_rad_m, double spacing_m);
/// Above this wavenumber low_pass is less than 1e-17.
double end_of_pass_rad_m(double spacing_m);
/// Below this wavenumber 1 - low_pass is less than 1e-14.
double remainder_from_rad_m(double spacing_m);

/// Quadrature along a contour in the first quadrant of k, on which H is smooth: poles and branch
/// points lie on or below the real axis. Its height, 7 / reach, limits |J0| to e^7.
struct PointRule {
    std::vector<std::complex<double>> k_rad_m;
    std::vector<std::complex<double>> weight; // with low_pass(k) k dk / (2 pi)
};
PointRule point_rule(double spacing_m, double reach_m);

/// Number of radii per grid spacing of a table of g, and of values used for interpolation.
inline constexpr double radii_per_spacing = 4.0;
inline constexpr int interpolated = 12;
/// Number of radii of a table up to this reach, and of the blocks in which they are computed.
std::size_t table_radii(double spacing_m, double reach_m);
std::size_t radial_blocks(double spacing_m, double reach_m);

/// Tables of g at radii 0, spacing/4, ... up to a reach, with the values that interpolation needs
/// beyond it. Keeps Bessel functions for further tables. Not collective.
class PointResponse {
public:
    PointResponse(double spacing_m, double reach_m);
    std::size_t radii() const { return bessel_.radii(); }
    const std::vector<std::complex<double>>& nodes_rad_m() const { return bessel_.k_rad_m(); }

    /// For each of `columns` functions whose values at the nodes are columns of `h`
    /// ([column][node]), g at all radii: [column][radius]. Calls `block_done` after each of
    /// radial_blocks(); if it returns false, the tables are incomplete.
    std::vector<std::complex<double>> tables(std::span<const std::complex<double>> h,
                                             std::size_t columns,
                                             const std::function<bool()>& block_done = {});

private:
    PointResponse(const PointRule& rule, double spacing_m, double reach_m);

    std::vector<std::complex<double>> weight_;
    BesselBlocks<std::complex<double>> bessel_;
};

/// Interpolates such tables at the points (i, j) spacing, i = 0 ... half_nx, j = 0 ... half_ny.
/// Error: 1e-8 at half of the highest wavenumber, 3e-6 at the highest one.
class PlaneSampling {
public:
    PlaneSampling(std::ptrdiff_t half_nx, std::ptrdiff_t half_ny);
    /// `out`: (half_nx + 1) (half_ny + 1) values, row-major.
    void sample(std::span<const std::complex<double>> table, std::complex<double>* out) const;

private:
    std::vector<std::ptrdiff_t> first_; // radius of the first value, which may be negative
    std::vector<double> weights_;
};

} // namespace shearwake::layered
