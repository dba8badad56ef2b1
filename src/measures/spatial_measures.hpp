// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"
#include "base/view.hpp"
#include "measures/surface_sums.hpp"
#include "problem/case/case.hpp"
#include "problem/load/load.hpp"

#include <span>
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

} // namespace shearwake::measures
