// SPDX-License-Identifier: BSD-3-Clause
#include "neural/hand/scene.hpp"

#include "base/field.hpp"
#include "base/text.hpp"
#include "neural/fibre/neuron.hpp"

#include <algorithm>
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

namespace {

/// Random number streams of one region and class.
enum Stream : std::uint32_t { shift, jitter, neuron };

/// Selects one of the neurons of the class by a number in (0, 1).
std::size_t any_row(AfferentClass kind, double u) {
    const std::size_t rows = neuron_rows(kind).size();
    return std::min(static_cast<std::size_t>(u * static_cast<double>(rows)), rows - 1);
}

std::uint64_t key_of(const std::string& place, AfferentClass kind, std::uint64_t seed) {
    return stable_hash(place + "/" + name_of(kind), stable_hash(std::to_string(seed)));
}

} // namespace

std::vector<Afferent> populate(const HandRegion& region, AfferentClass kind, std::uint64_t seed) {
    const double pitch_mm = 10.0 / std::sqrt(density_per_cm2(kind, region.kind));
    const std::uint64_t key = key_of(region.name, kind, seed);
    const auto [shift_x, shift_y] = two_uniforms(key, shift, 0);
    const Box box = bounding_box(region.outline_mm);
    // One additional pitch on every side, for points that are moved inwards.
    const auto points = [&](double length_mm) {
        return static_cast<std::uint64_t>(std::ceil(length_mm / pitch_mm)) + 2;
    };
    const std::uint64_t columns = points(box.high.x - box.low.x),
                        rows = points(box.high.y - box.low.y);
    std::vector<Afferent> afferents;
    for (std::uint64_t n = 0; n < columns * rows; ++n) {
        const Vec2 cell = {static_cast<double>(n % columns), static_cast<double>(n / columns)};
        const auto [dx, dy] = two_normals(key, jitter, n);
        const Vec2 at_mm =
            box.low + pitch_mm * (cell + Vec2{shift_x - 1.0 + 0.2 * dx, shift_y - 1.0 + 0.2 * dy});
        if (contains(region.outline_mm, at_mm))
            afferents.push_back({at_mm, kind, any_row(kind, two_uniforms(key, neuron, n)[0])});
    }
    return afferents;
}

std::vector<Afferent> populate(std::span<const HandRegion> regions,
                               std::span<const AfferentClass> kinds, std::uint64_t seed) {
    std::vector<Afferent> all;
    for (const HandRegion& region : regions)
        for (const AfferentClass kind : kinds)
            for (const Afferent& afferent : populate(region, kind, seed))
                all.push_back(afferent);
    return all;
}

std::vector<Afferent> grid_of_afferents(Vec2 center_mm, Vec2 extent_mm, double pitch_mm,
                                        std::span<const AfferentClass> kinds, std::uint64_t seed) {
    const auto half = [&](double length_mm) {
        return static_cast<std::ptrdiff_t>(std::floor(0.5 * length_mm / pitch_mm + 1e-9));
    };
    const std::ptrdiff_t half_x = half(extent_mm.x), half_y = half(extent_mm.y);
    std::vector<Afferent> all;
    for (const AfferentClass kind : kinds) {
        const std::uint64_t key = key_of("grid", kind, seed);
        std::uint64_t n = 0;
        for (std::ptrdiff_t i = -half_x; i <= half_x; ++i)
            for (std::ptrdiff_t j = -half_y; j <= half_y; ++j)
                all.push_back(
                    {center_mm + pitch_mm * Vec2{static_cast<double>(i), static_cast<double>(j)},
                     kind, any_row(kind, two_uniforms(key, neuron, n++)[0])});
    }
    return all;
}

} // namespace shearwake::neural
