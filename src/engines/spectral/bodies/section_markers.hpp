// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/rigid_choice.hpp"
#include "engines/spectral/depth/depth_mesh.hpp"

#include <array>
#include <vector>

namespace shearwake::spectral {

/// Standard deviation of the smoothing across the axis of an endless body, in grid spacings: each
/// marker evaluates the displacement and exerts its force with this Gaussian, which the grid
/// resolves.
constexpr double marker_smoothing = 0.5;
/// Distance of markers along the surface and of those inside, in grid spacings.
constexpr double marker_spacing = 1.2, inner_spacing = 2.5;
/// Distance by which markers stand inside a vertical face, in grid spacings. A sheet of sources
/// with the potential -|x|/2, smoothed twice by the Gaussian, has the mean distance 2
/// sigma/sqrt(pi) from itself and acts like a sharp surface up to that far outside. In z nothing is
/// smoothed.
constexpr double flat_inset = 1.1283791670955126 * marker_smoothing;
/// The same for the vertical parts of a curved surface: the distance at which the effect of a
/// cylinder on the surface changes least with the spacing, by 1 % at 5 spacings per radius and by
/// 0.2 % at 10, free or fixed. (At 0.28 and 0.56 it changes by 4 and 3 % at 5.)
constexpr double curved_inset = 0.42;

/// The cross-section of an endless body: a circle or a rectangle.
struct CrossSection {
    bool is_round;
    double half_across_m, half_down_m;
};
CrossSection cross_section(const Body& body, Endless along);

/// Angles in the first quarter of an ellipse, from the axis of `b` towards that of `a`, that are
/// equally far apart along it, half a distance from the axes. The distance is near `spacing`;
/// `steps` are those of the integral along the quarter.
std::vector<double> quarter_angles(double a, double b, double spacing, int steps);

/// A point of the cross-section of an endless body, relative to the body's centre.
struct SectionMarker {
    double across_m, down_m;
};

/// Markers on the surface of the cross-section and inside, symmetric about the vertical, ordered by
/// depth; the markers of one depth are consecutive. `spacing_z_m` is the largest distance of levels
/// near the body. Not collective.
std::vector<SectionMarker> section_markers(const Body& body, Endless along, double spacing_m,
                                           double spacing_z_m);

/// The largest distance of consecutive levels in the elements between two depths.
double level_spacing_m(const DepthMesh& mesh, double top_m, double bottom_m);

/// Density of the layer at a depth. Not collective.
double density_at(const Medium& medium, double depth_m);

/// The degrees of freedom of an endless body: displacement along the axis, across it and along z,
/// and the rotation about the axis through the centre, by which a point moves as
///     u_across = z angle, u_z = -y angle   (across y, down z from the centre).
constexpr std::size_t section_freedoms = 4;
/// Mass per length of the body in excess of the background in its place, [row][column] of the
/// degrees of freedom [kg/m, kg, kg m].
using SectionMass = std::array<double, section_freedoms * section_freedoms>;
SectionMass excess_mass(const Body& body, Endless along, const Medium& medium);

} // namespace shearwake::spectral
