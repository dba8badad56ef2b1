// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/footprint.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

namespace test_drawn_shape {

using namespace shearwake;

static Travel along(Curve path) {
    return {.path = std::move(path), .motion = ConstantSpeed{1.0}, .at_end = AtEnd::repeat};
}

TEST_CASE("a small pattern draws the path of its centre", "[drawn_shape]") {
    const Modulation modulation{.kind = "STP",
                                .trajectory = {{along(Arc{{}, 15e-3, 0.0, 6.283185307179586}),
                                                along(Arc{{}, 2e-3, 0.0, 6.283185307179586})}},
                                .envelope = {}};
    const auto lines = drawn_shape(modulation, 1e-3);
    REQUIRE(lines.size() == 1);
    for (const Vec2 point : lines.front())
        CHECK(norm(point) == Approx(15e-3).epsilon(1e-12)); // rounding
    for (std::size_t n = 1; n < lines.front().size(); ++n)
        CHECK(norm(lines.front()[n] - lines.front()[n - 1]) <= 1e-3);
}

TEST_CASE("a drawn square keeps its corners", "[drawn_shape]") {
    const Polyline square({{0.0, 0.0}, {0.03, 0.0}, {0.03, 0.03}, {0.0, 0.03}}, Ends::closed);
    const Modulation modulation{
        .kind = "STM", .trajectory = {{along(square), Hold{{0.01, 0.0}}}}, .envelope = {}};
    const std::vector<Vec2> line = drawn_shape(modulation, 0.7e-3).front();
    for (const Vec2 corner : square.points_m())
        CHECK(std::any_of(line.begin(), line.end(), [&](Vec2 p) {
            return norm(p - corner - Vec2{0.01, 0.0}) < 1e-15; // rounding
        }));
}

TEST_CASE("static foci draw themselves, a swing its line", "[drawn_shape]") {
    const Modulation foci{.kind = "AM",
                          .trajectory = {{Hold{{1e-3, 0.0}}}},
                          .envelope = {},
                          .foci_m = {{-5e-3, 0.0}, {5e-3, 0.0}}};
    CHECK(drawn_shape(foci, 1e-3) ==
          std::vector<std::vector<Vec2>>{{{1e-3 + -5e-3, 0.0}}, {{1e-3 + 5e-3, 0.0}}});
    const Modulation swing{
        .kind = "LM", .trajectory = {{Hold{}, Swing{.amplitude_m = {2e-3, 0.0}}}}, .envelope = {}};
    const auto line = drawn_shape(swing, 10e-3).front();
    CHECK(line.front() == Vec2{-2e-3, 0.0});
    CHECK(line.back() == Vec2{2e-3, 0.0});
}

} // namespace test_drawn_shape
