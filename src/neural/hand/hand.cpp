// SPDX-License-Identifier: BSD-3-Clause
#include "neural/hand/hand.hpp"

#include "base/error.hpp"
#include "base/units.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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

} // namespace shearwake::neural
