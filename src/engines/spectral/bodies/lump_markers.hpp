// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"
#include "engines/spectral/bodies/section_markers.hpp"

#include <array>
#include <vector>

namespace shearwake::spectral {

/// A lump: the body, or the part of an endless cylinder or box inside the domain. Not collective.
Body lump_in(const Body& body, const Domain& domain);

/// The points at which a lump is constrained, as offsets [m] from `body.centre_m`, ordered by
/// depth: about marker_spacing apart on its surface, which is shifted inwards by curved_inset or
/// flat_inset in the lateral directions, and about inner_spacing apart inside. Points whose depths
/// differ by less than 0.3 of `spacing_z_m`, the distance of levels, share a depth. The markers of
/// a turned body are those of the same body without its orientation, turned, and are shifted
/// inwards in proportion to the lateral part of the normal. Markers are symmetric as the body is,
/// except for the depths that they share. A body that crosses the domain along x or y has markers
/// all around the period. Not collective.
std::vector<Vec3> lump_markers(const Body& body, const Domain& domain, double spacing_z_m);

/// The degrees of freedom of a lump: displacement along x, y and z, and rotation about these axes
/// through the centre.
constexpr std::size_t lump_freedoms = 6;
/// Motion of a point at an offset from the centre for each degree of freedom.
std::array<Vec3, lump_freedoms> motions_at(Vec3 offset_m);
/// Mass of the body in excess of the background in its place, [row][column] of the degrees of
/// freedom [kg, kg m, kg m^2]. The mass is accurate to 1e-5 and the inertia to 5e-4.
std::vector<double> lump_mass(const Body& body, const Domain& domain, const Medium& medium);

/// For markers on a grid and on levels with these spacings: makes those whose depths differ by less
/// than 0.3 spacings share a depth, since each depth costs one response, and replaces those that
/// are closer to each other than 0.4 spacings by their mean, since the forces on them are hardly
/// determined. Preserves the symmetry in x and y. Not collective.
void join_close_points(double across_m, double down_m, std::vector<Vec3>& points);

} // namespace shearwake::spectral
