// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/layered/radial_interpolant.hpp"
#include "engines/layered/stack_response.hpp"

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

/// Panels of L up to the end of low_pass. Throws CaseFailure if L is not finite. Not collective.
RadialInterpolant fit_loss(const StackResponse& response, double spacing_m, double tolerance);

/// Number of nodes of the fixed panels. Not collective.
std::size_t loss_nodes(double spacing_m, double reach_m);

/// For each function, l at the radii 0, spacing/4, ...: [function][radius]. `reach_m` is the
/// largest radius for which it is accurate. Calls `block_done` after each block of radii_together
/// radii. Not collective.
std::vector<std::complex<double>> loss_tables(std::span<const RadialInterpolant> losses,
                                              double spacing_m, double reach_m, std::size_t radii,
                                              const std::function<void()>& block_done = {});

} // namespace shearwake::layered
