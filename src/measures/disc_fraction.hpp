// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vec2.hpp"

namespace shearwake::measures {

/// Fraction (0 to 1) of the square cell of side spacing_m centred on (x_m, y_m) that lies inside
/// the disc of this centre and radius: the exact area of their intersection over that of the cell.
/// Over all cells of a grid the fractions times spacing^2 add up to pi radius^2.
double disc_fraction(double x_m, double y_m, double spacing_m, Vec2 centre, double radius_m);

} // namespace shearwake::measures
