// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/plan.hpp"

#include <vector>

namespace shearwake::adapt {

/// Values of a column along the points of an axis; NaN: none. For crossings, the level has been
/// subtracted.
using Curve = std::vector<double>;

/// An estimate of the largest error of linear interpolation in each interval of the ascending
/// points `x`, h^2 / 2 |f''|: the largest second divided difference at both ends and at the next
/// point beyond each, because a curve can have an inflection point at an end. With points that are
/// uniformly spaced this is the distance of a point from the line through its neighbours. It is the
/// error if the slope changes abruptly in the middle of the interval, and four times that of a
/// parabola. Points without a value are left out; NaN where fewer than three values are nearby.
/// Size: one less than `x`.
std::vector<double> interpolation_errors(const std::vector<double>& x, const Curve& curve);

/// The points to add to the ascending points `x` in the next round, ascending. None: the axis has
/// reached its tolerance or the largest number of points. They depend on the arguments alone.
std::vector<double> next_points(const AdaptiveAxis& axis, const std::vector<double>& x,
                                const std::vector<Curve>& curves);

/// The points of the first round.
std::vector<double> first_points(const AdaptiveAxis& axis);

/// Where an extremum or a crossing is, in the unit of the key.
struct Location {
    double at = 0.0;             // extremum: the best point; crossing: by linear interpolation
    double from = 0.0, to = 0.0; // the neighbouring points
    double value = 0.0;          // of the curve; 0 for a crossing
};

/// The extremum or the crossings of a curve, ascending; none for `refine`.
std::vector<Location> locations(const AdaptiveAxis& axis, const std::vector<double>& x,
                                const Curve& curve);

} // namespace shearwake::adapt
