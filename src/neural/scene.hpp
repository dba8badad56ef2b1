#pragma once

#include "model/afferents.hpp"
#include "neural/afferent.hpp"
#include "neural/hand.hpp"

#include <vector>

namespace shearwake::neural {

/// The patch of skin on the hand: what is asked for, in mm. Where waves spread on a flat sheet
/// there still is a hand, on which its afferents lie.
struct Scene {
    Hand hand;
    std::vector<Afferent> afferents; // in the hand's coordinates
    std::vector<Vec2> pins_mm;       // likewise
    Polygon skin_mm;                 // within which waves spread; empty: endless
};

Scene make_scene(const AfferentOptions& options);

/// From the patch's coordinates [m] to the hand's [mm], and back.
Vec2 on_hand_mm(const AfferentOptions& options, Vec2 patch_m);
Vec2 on_patch_m(const AfferentOptions& options, Vec2 hand_mm);

/// Where the patch's middle lies if nothing else is said: the middle of the part of the hand, [m].
Vec2 usual_patch_m(const AfferentPlaces& places);

/// The regions of the hand that a choice names.
std::vector<HandRegion> regions_of(const Hand& hand, const HandAfferents& places);

} // namespace shearwake::neural
