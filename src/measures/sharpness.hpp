#pragma once

#include "base/vec2.hpp"
#include "base/view.hpp"
#include "measures/surface_sums.hpp"
#include "model/case.hpp"

#include <span>
#include <vector>

namespace shearwake {

/// For each sample of the whole surface, row-major, its cell's share within `reach_m` of the lines:
/// 1 or 0, and between them where the cell's middle is less than half a spacing from that distance.
/// Not collective.
std::vector<double> shares_near(std::span<const std::vector<Vec2>> lines, double reach_m,
                                const Domain& domain);

/// Sharpness of a drawn shape: the share of the region's energy, sum w E / sum E, that lies within
/// reach_m of its lines. E, of the whole surface, is the time mean of u_z^2. NaN where E is zero
/// throughout. Not collective.
double sharpness(View2<const double> mean_u2, const Domain& domain, const Region& region,
                 std::span<const std::vector<Vec2>> lines, double reach_m);

} // namespace shearwake
