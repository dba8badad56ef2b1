// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vec3.hpp"

#include <vector>

namespace shearwake::spectral {

/// For markers on a grid and on levels with these spacings: makes those whose depths differ by less
/// than 0.3 spacings share a depth, since each depth costs one response, and replaces those that
/// are closer to each other than 0.4 spacings by their mean, since the forces on them are hardly
/// determined. Preserves the symmetry in x and y. Not collective.
void join_close_points(double across_m, double down_m, std::vector<Vec3>& points);

} // namespace shearwake::spectral
