// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vec2.hpp"
#include "base/view.hpp"
#include "measures/surface_sums.hpp"
#include "problem/case/case.hpp"

#include <span>
#include <vector>

namespace shearwake::measures {

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

} // namespace shearwake::measures
