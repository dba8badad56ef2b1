// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "neural/fibre/afferent.hpp"
#include "neural/hand/hand.hpp"
#include "problem/case/afferents.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace shearwake::neural {

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
