// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/layered/response/bessel_blocks.hpp"
#include "engines/layered/response/radial_interpolant.hpp"
#include "engines/layered/response/stack_response.hpp"

#include <complex>
#include <functional>
#include <span>
#include <vector>

namespace shearwake::layered {

// The loss L(k) of StackResponse::loss as a function of the distance r of two points of the load,
//
//     l(r) = 1/(2 pi) integral_0^inf L(k) low_pass(k) J0(k r) k dk.
//
// Unlike H, L contains conjugates and is not analytic in k, so the integral cannot leave the real
// axis. Panels of L become narrow at its peaks, the guided waves. Their integrals against the
// polynomials of fixed panels, in which J0(k r) is smooth, are the same for all radii.

/// Panels of L up to the end of low_pass. Throws CaseFailure if L is not resolved. Not collective.
RadialInterpolant fit_loss(const StackResponse& response, double spacing_m, double tolerance);

/// Panels of equal width on the real axis.
class FixedPanels {
public:
    FixedPanels(double spacing_m, double reach_m);
    std::vector<double> nodes_rad_m() const;
    /// Values at the nodes whose sum with a function is the integral of L low_pass k / (2 pi) times
    /// that function.
    std::vector<std::complex<double>> project(const RadialInterpolant& loss) const;

private:
    double width() const { return end_rad_m_ / static_cast<double>(count_); }

    double spacing_m_, end_rad_m_;
    std::size_t count_;
};

/// Tables of l at the same radii as those of PointResponse. Keeps Bessel functions for further
/// tables. Not collective.
class LossResponse {
public:
    LossResponse(double spacing_m, double reach_m);

    /// For each function, l at all radii: [function][radius]. Calls `block_done` after each of
    /// radial_blocks(); if it returns false, the tables are incomplete.
    std::vector<std::complex<double>> tables(std::span<const RadialInterpolant> losses,
                                             const std::function<bool()>& block_done = {});

private:
    FixedPanels panels_;
    BesselBlocks<double> bessel_;
};

} // namespace shearwake::layered
