// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"
#include "neural/fibre/fibre.hpp"
#include "problem/case/afferents.hpp"

#include <cstdint>
#include <span>
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

/// Fibres of a class in a region at its natural density. A square grid with the pitch h = 10 mm /
/// sqrt(density per cm2) covers the bounding box of the region, shifted randomly by up to h along x
/// and y. Each grid point is moved by N(0, (h/5)^2) along both axes and becomes a fibre if it is
/// inside the region. Its neuron is chosen from those of the class with equal probability. The
/// random numbers depend only on the seed, the region's name, the class and the grid point.
/// Therefore they are the same on every machine, and the fibres of a region do not depend on which
/// other regions are populated. Not collective.
std::vector<Afferent> populate(const HandRegion& region, AfferentClass kind, std::uint64_t seed);

/// Fibres of several regions and classes, ordered by region and then by class.
std::vector<Afferent> populate(std::span<const HandRegion> regions,
                               std::span<const AfferentClass> kinds, std::uint64_t seed);

/// One fibre of each class at every point of a regular grid around `center_mm`; the neurons are
/// chosen as in populate().
std::vector<Afferent> grid_of_afferents(Vec2 center_mm, Vec2 extent_mm, double pitch_mm,
                                        std::span<const AfferentClass> kinds, std::uint64_t seed);

/// Position of the moving patch of skin on the hand.
struct Patch {
    Vec2 middle_m;
    double turn_rad = 0.0;
};

/// The patch given by the options. Its default middle is that of the selected part of the hand,
/// rounded to millimetres. Not collective.
Patch patch_of(const AfferentOptions& options);

/// Convert between coordinates of the patch [m] and of the hand [mm]. Not collective.
Vec2 on_hand_mm(const Patch& patch, Vec2 at_m);
Vec2 on_patch_m(const Patch& patch, Vec2 hand_mm);

/// The requested afferents and pins in mm. On a flat sheet of skin the afferents are still placed
/// on a hand.
struct Scene {
    Hand hand;
    Patch patch;
    std::vector<Afferent> afferents; // in the hand's coordinates
    std::vector<Vec2> pins_mm;       // in the hand's coordinates
    Polygon skin_mm;                 // outline within which waves propagate; empty: unbounded
};

/// Places the afferents and pins that the options request. Throws Error for an unknown region of
/// the hand. Not collective.
Scene make_scene(const AfferentOptions& options);

/// The regions of the hand that the options select. Throws Error if there is none.
std::vector<HandRegion> regions_of(const Hand& hand, const HandAfferents& places);

} // namespace shearwake::neural
