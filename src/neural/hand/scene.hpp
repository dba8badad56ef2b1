// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "neural/fibre/afferent.hpp"
#include "neural/hand/hand.hpp"
#include "problem/case/afferents.hpp"

#include <vector>

namespace shearwake::neural {

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
