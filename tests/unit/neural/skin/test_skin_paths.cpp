// SPDX-License-Identifier: BSD-3-Clause
#include "neural/skin/skin.hpp"

#include "neural/hand/hand.hpp"

#include <catch2/catch.hpp>

#include <cmath>

namespace test_skin_paths {

using namespace shearwake;
using namespace shearwake::neural;

/// A horseshoe: two fingers of 10 mm width and 50 mm length, 10 mm apart, on a bar of 10 mm.
const Polygon horseshoe = {{0, 0},   {30, 0},  {30, 60}, {20, 60},
                           {20, 10}, {10, 10}, {10, 60}, {0, 60}};

static double way_mm(const Polygon& outline, Vec2 from, Vec2 to) {
    return paths_within(outline, {from})(to).at(0);
}

TEST_CASE("path without an obstacle is straight", "[hand]") {
    CHECK(way_mm(horseshoe, {2, 2}, {8, 50}) == norm(Vec2{6, 48}));
    CHECK(way_mm(horseshoe, {2, 2}, {28, 9}) == norm(Vec2{26, 7}));
    CHECK(straight_paths({{0, 0}, {5, 50}})({25, 50}) == std::vector{norm(Vec2{25, 50}), 20.0});
}

TEST_CASE("path between fingers bends at the two corners of the gap", "[hand]") {
    // 40 mm down, 10 mm across and 40 mm up, each with a lateral offset of 5 mm.
    CHECK(way_mm(horseshoe, {5, 50}, {25, 50}) ==
          Approx(2.0 * std::hypot(5.0, 40.0) + 10.0).epsilon(1e-14));
    // From the bar the path bends at one corner only.
    CHECK(way_mm(horseshoe, {5, 50}, {29, 1}) ==
          Approx(std::hypot(5.0, 40.0) + std::hypot(19.0, 9.0)).epsilon(1e-14));
}

TEST_CASE("path lengths are symmetric", "[hand]") {
    const Hand hand = make_hand();
    const Vec2 a = centroid(region(hand, "D5d").outline_mm),
               b = centroid(region(hand, "D1d").outline_mm);
    CHECK(way_mm(hand.outline_mm, a, b) == Approx(way_mm(hand.outline_mm, b, a)).epsilon(1e-14));
}

TEST_CASE("path between fingertips leads through the palm", "[hand]") {
    const Hand hand = make_hand();
    const auto between = [&](const char* from, const char* to) {
        return way_mm(hand.outline_mm, centroid(region(hand, from).outline_mm),
                      centroid(region(hand, to).outline_mm));
    };
    // Drawing of Saal et al.: 155 mm, straight distance 40 mm. The corners of our drawing differ.
    CHECK(between("D3d", "D4d") == Approx(155.0).epsilon(0.12));
    CHECK(between("palm", "D2p") == Approx(75.0).epsilon(0.03)); // straight: 74.2 and 10.6
}

TEST_CASE("there is no path from or to points outside of the skin", "[hand]") {
    CHECK(std::isinf(way_mm(horseshoe, {15, 30}, {5, 50})));
    CHECK(std::isinf(way_mm(horseshoe, {5, 50}, {15, 30})));
    CHECK(std::isinf(way_mm(horseshoe, {-1, 5}, {5, 5})));
}

} // namespace test_skin_paths
