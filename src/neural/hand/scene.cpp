// SPDX-License-Identifier: BSD-3-Clause
#include "neural/hand/scene.hpp"

#include "base/overloaded.hpp"
#include "neural/hand/population.hpp"

#include <cmath>
#include <fmt/format.h>

namespace shearwake::neural {
namespace {

Vec2 turned(Vec2 v, double angle_rad) {
    const double c = std::cos(angle_rad), s = std::sin(angle_rad);
    return {c * v.x - s * v.y, s * v.x + c * v.y};
}

} // namespace

Patch patch_of(const AfferentOptions& options) {
    if (options.patch_m) return {*options.patch_m, options.patch_rad};
    const auto* part = std::get_if<HandAfferents>(&options.places);
    const Hand hand = make_hand();
    const Polygon around = part && part->part == "fingertip"
                               ? regions_of(hand, *part).front().outline_mm
                               : region(hand, "palm").outline_mm;
    const Vec2 middle_mm = centroid(around);
    return {{1e-3 * std::round(middle_mm.x), 1e-3 * std::round(middle_mm.y)}, options.patch_rad};
}

Vec2 on_hand_mm(const Patch& patch, Vec2 at_m) {
    return 1e3 * (patch.middle_m + turned(at_m, patch.turn_rad));
}

Vec2 on_patch_m(const Patch& patch, Vec2 hand_mm) {
    return turned(1e-3 * hand_mm - patch.middle_m, -patch.turn_rad);
}

std::vector<HandRegion> regions_of(const Hand& hand, const HandAfferents& places) {
    if (places.part == "hand") return hand.regions;
    if (places.part == "palm") return {region(hand, "palm")};
    return {region(hand, fmt::format("D{}d", places.digit))};
}

Scene make_scene(const AfferentOptions& options) {
    Scene scene{.hand = make_hand(), .patch = patch_of(options)};
    const double to_mm = 1e3;
    std::visit(overloaded{
                   [&](const HandAfferents& places) {
                       scene.afferents =
                           populate(regions_of(scene.hand, places), options.classes, options.seed);
                   },
                   [&](const GridAfferents& grid) {
                       scene.afferents =
                           grid_of_afferents({}, to_mm * grid.extent_m, to_mm * grid.pitch_m,
                                             options.classes, options.seed);
                       for (Afferent& afferent : scene.afferents)
                           afferent.at_mm = on_hand_mm(scene.patch, 1e-3 * afferent.at_mm);
                   },
                   [&](const AfferentList& list) {
                       for (const ListedAfferent& one : list.all)
                           scene.afferents.push_back(
                               {on_hand_mm(scene.patch, one.at_m), one.kind, one.row});
                   },
               },
               options.places);
    for (const Vec2 pin_m : options.pins_m)
        scene.pins_mm.push_back(on_hand_mm(scene.patch, pin_m));
    if (options.sheet == SkinSheet::hand) scene.skin_mm = scene.hand.outline_mm;
    return scene;
}

} // namespace shearwake::neural
