// SPDX-License-Identifier: BSD-3-Clause
#include "neural/hand/hand.hpp"

#include "base/error.hpp"
#include "base/field.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "neural/fibre/fibre.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <numeric>

namespace shearwake::neural {
namespace {

/// A finger from the palm to the tip. Half widths are given at the base and at the end of each
/// phalanx except the last one, whose end is a half ellipse.
struct Finger {
    const char* name;
    Vec2 base_mm;
    double direction_deg;
    std::vector<double> phalanges_mm, half_widths_mm;
    double rounding_mm; // length of the half ellipse
};

const std::array<Finger, 5>& fingers() {
    static const std::array<Finger, 5> all = {{
        {"D5", {101.6, 67.5}, 134.5, {21.0, 19.1, 23.7}, {8.6, 7.1, 6.25}, 8.9},
        {"D4", {81.6, 49.7}, 150.0, {29.0, 26.6, 28.8}, {9.2, 9.4, 7.7}, 9.2},
        {"D3", {68.1, 25.0}, 159.1, {35.6, 26.2, 27.15}, {10.5, 9.35, 8.3}, 9.1},
        {"D2", {65.3, -1.3}, 179.3, {26.2, 25.7, 27.4}, {9.5, 9.7, 8.4}, 9.3},
        {"D1", {122.9, -40.2}, -157.3, {40.1, 31.4}, {8.8, 9.2}, 9.2},
    }};
    return all;
}

/// The part of the palm's edge that does not touch a finger: between index finger and thumb, and
/// from the thumb around the wrist to the little finger.
constexpr std::array<Vec2, 4> web_mm = {
    {{71.0, -13.0}, {80.0, -15.5}, {93.0, -18.0}, {106.0, -22.0}}};
constexpr std::array<Vec2, 15> heel_mm = {{{139.0, -45.5},
                                           {151.0, -43.0},
                                           {163.0, -39.0},
                                           {174.0, -34.0},
                                           {184.0, -29.5},
                                           {187.5, -20.0},
                                           {189.0, -5.0},
                                           {187.5, 10.0},
                                           {183.0, 24.0},
                                           {175.0, 37.0},
                                           {164.0, 45.5},
                                           {151.0, 53.5},
                                           {138.0, 60.0},
                                           {126.0, 66.0},
                                           {115.0, 71.0}}};

/// The position on a finger at the given distances along its axis and to its left.
Vec2 on(const Finger& finger, double along_mm, double left_mm) {
    const double angle = to_radians(finger.direction_deg);
    const Vec2 ahead = {std::cos(angle), std::sin(angle)}, left = {-ahead.y, ahead.x};
    return finger.base_mm + along_mm * ahead + left_mm * left;
}

double length_mm(const Finger& finger, std::size_t phalanges) {
    const auto end = finger.phalanges_mm.begin() + static_cast<std::ptrdiff_t>(phalanges);
    return std::accumulate(finger.phalanges_mm.begin(), end, 0.0);
}

/// The end of the last phalanx from its right to its left side.
Polygon rounded_end(const Finger& finger) {
    constexpr int corners = 9;
    const double along_mm = length_mm(finger, finger.phalanges_mm.size()) - finger.rounding_mm;
    Polygon end;
    for (int i = 0; i < corners; ++i) {
        const double angle = std::numbers::pi * (static_cast<double>(i) / (corners - 1) - 0.5);
        end.push_back(on(finger, along_mm + finger.rounding_mm * std::cos(angle),
                         finger.half_widths_mm.back() * std::sin(angle)));
    }
    return end;
}

std::vector<HandRegion> phalanges(const Finger& finger) {
    std::vector<HandRegion> regions;
    const std::size_t count = finger.phalanges_mm.size();
    for (std::size_t i = 0; i < count; ++i) {
        const bool is_tip = i + 1 == count;
        const double from_mm = length_mm(finger, i), to_mm = length_mm(finger, i + 1);
        const double width_mm = finger.half_widths_mm[i];
        Polygon outline = {on(finger, from_mm, -width_mm)};
        if (is_tip) {
            for (const Vec2 corner : rounded_end(finger))
                outline.push_back(corner);
        } else {
            outline.push_back(on(finger, to_mm, -finger.half_widths_mm[i + 1]));
            outline.push_back(on(finger, to_mm, finger.half_widths_mm[i + 1]));
        }
        outline.push_back(on(finger, from_mm, width_mm));
        const char* part = is_tip ? "d" : i == 0 ? "p" : "m";
        regions.push_back(
            {finger.name + std::string(part), is_tip ? SkinKind::tip : SkinKind::finger, outline});
    }
    return regions;
}

/// Follows the right side to the tip and the left side back.
void walk_around(const Finger& finger, Polygon& outline) {
    for (std::size_t i = 0; i < finger.phalanges_mm.size(); ++i)
        outline.push_back(on(finger, length_mm(finger, i), -finger.half_widths_mm[i]));
    for (const Vec2 corner : rounded_end(finger))
        outline.push_back(corner);
    for (std::size_t i = finger.phalanges_mm.size(); i-- > 0;)
        outline.push_back(on(finger, length_mm(finger, i), finger.half_widths_mm[i]));
}

} // namespace

Hand make_hand() {
    Hand hand;
    HandRegion palm{"palm", SkinKind::palm, {}};
    for (const Finger& finger : fingers()) {
        if (finger.name == std::string("D1")) {
            hand.outline_mm.insert(hand.outline_mm.end(), web_mm.begin(), web_mm.end());
            palm.outline_mm.insert(palm.outline_mm.end(), web_mm.begin(), web_mm.end());
        }
        for (HandRegion& phalanx : phalanges(finger))
            hand.regions.push_back(std::move(phalanx));
        walk_around(finger, hand.outline_mm);
        palm.outline_mm.push_back(on(finger, 0.0, -finger.half_widths_mm.front()));
        palm.outline_mm.push_back(on(finger, 0.0, finger.half_widths_mm.front()));
    }
    hand.outline_mm.insert(hand.outline_mm.end(), heel_mm.begin(), heel_mm.end());
    palm.outline_mm.insert(palm.outline_mm.end(), heel_mm.begin(), heel_mm.end());
    hand.regions.push_back(std::move(palm));
    return hand;
}

const HandRegion& region(const Hand& hand, const std::string& name) {
    for (const HandRegion& r : hand.regions)
        if (r.name == name) return r;
    throw Error("the hand has no region " + name);
}

double density_per_cm2(AfferentClass kind, SkinKind skin) {
    const ReceptorClass& c = properties(kind);
    return skin == SkinKind::palm     ? c.palm_per_cm2
           : skin == SkinKind::finger ? c.finger_per_cm2
                                      : c.tip_per_cm2;
}

namespace {

double cross(Vec2 a, Vec2 b) {
    return a.x * b.y - a.y * b.x;
}

/// Calls visit(from, to) for every side.
template <class Visit>
void each_side(const Polygon& polygon, const Visit& visit) {
    for (std::size_t i = 0; i < polygon.size(); ++i)
        visit(polygon[i], polygon[(i + 1) % polygon.size()]);
}

double signed_area(const Polygon& polygon) {
    double twice = 0.0;
    each_side(polygon, [&](Vec2 a, Vec2 b) { twice += cross(a, b); });
    return 0.5 * twice;
}

} // namespace

double area(const Polygon& polygon) {
    return std::abs(signed_area(polygon));
}

Vec2 centroid(const Polygon& polygon) {
    Vec2 sum;
    each_side(polygon, [&](Vec2 a, Vec2 b) { sum = sum + cross(a, b) * (a + b); });
    return 1.0 / (6.0 * signed_area(polygon)) * sum;
}

Box bounding_box(const Polygon& polygon) {
    Box box{polygon.front(), polygon.front()};
    for (const Vec2 p : polygon) {
        box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
        box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
    }
    return box;
}

bool contains(const Polygon& polygon, Vec2 point) {
    bool within = false; // an odd number of sides crosses the ray from the point along x
    each_side(polygon, [&](Vec2 a, Vec2 b) {
        if ((a.y > point.y) == (b.y > point.y)) return;
        const double x = a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x);
        if (point.x < x) within = !within;
    });
    return within;
}

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
