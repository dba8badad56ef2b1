#pragma once

#include "model/afferents.hpp"
#include "neural/afferent.hpp"
#include "neural/hand.hpp"

#include <vector>

namespace shearwake::neural {

/// Where the patch of skin that moves lies on the hand.
struct Patch {
    Vec2 middle_m;
    double turn_rad = 0.0;
};

/// As the options say; the middle, if they do not, is that of the part of the hand, rounded to mm.
Patch patch_of(const AfferentOptions& options);

/// From the patch's coordinates [m] to the hand's [mm], and back.
Vec2 on_hand_mm(const Patch& patch, Vec2 at_m);
Vec2 on_patch_m(const Patch& patch, Vec2 hand_mm);

/// What is asked for, in mm. Where waves spread on a flat sheet there still is a hand, on which its
/// afferents lie.
struct Scene {
    Hand hand;
    Patch patch;
    std::vector<Afferent> afferents; // in the hand's coordinates
    std::vector<Vec2> pins_mm;       // likewise
    Polygon skin_mm;                 // within which waves spread; empty: endless
};

Scene make_scene(const AfferentOptions& options);

/// The regions of the hand that a choice names.
std::vector<HandRegion> regions_of(const Hand& hand, const HandAfferents& places);

} // namespace shearwake::neural
