// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"
#include "neural/fibre/afferent.hpp"

#include <string>
#include <vector>

namespace shearwake::neural {

/// Corners of a simple polygon without holes, in either orientation.
using Polygon = std::vector<Vec2>;

/// An axis-parallel rectangle.
struct Box {
    Vec2 low, high;
};

/// Area, centroid and bounding box of a polygon, in its units. Not collective.
double area(const Polygon& polygon);
Vec2 centroid(const Polygon& polygon);
Box bounding_box(const Polygon& polygon);
/// Whether the point is inside. The result for a point on a side is unspecified. Not collective.
bool contains(const Polygon& polygon, Vec2 point);

/// Kinds of skin with different densities of fibres.
enum class SkinKind { palm, finger, tip };

/// A part of the hand with uniform skin.
struct HandRegion {
    std::string name; // "palm"; "D2p", "D2m", "D2d": digit (1: thumb), proximal to distal phalanx
    SkinKind kind;
    Polygon outline_mm;
};

/// The palmar side of a right hand, 166 cm2. The origin is the pad of the index finger; x points
/// along this finger towards the wrist, y from the thumb towards the little finger.
struct Hand {
    std::vector<HandRegion> regions;
    Polygon outline_mm; // union of the regions
};

/// A hand drawn for this program: five fingers, each a chain of tapering phalanges with a rounded
/// end, and a palm. Positions, directions and sizes are fitted to the areas, centres and bounding
/// boxes of the hand regions of Saal et al. (PNAS 2017). The breadths of joints agree with those of
/// Garrett, Human Factors 13 (1971) 117, within 3 mm. Not collective.
Hand make_hand();

/// The region with this name. Throws Error if there is none. Not collective.
const HandRegion& region(const Hand& hand, const std::string& name);

/// Fibres per square centimetre of palm, finger and tip: Johansson and Vallbo, J. Physiol. 286
/// (1979) 283, as used by Saal et al. (PNAS 2017). Not collective.
double density_per_cm2(AfferentClass kind, SkinKind skin);

} // namespace shearwake::neural
