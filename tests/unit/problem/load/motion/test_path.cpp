// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/motion/path.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <set>

namespace test_path {

using namespace shearwake;

constexpr double pi = std::numbers::pi;
/// Closed forms and these differ by a few roundings of numbers below 0.1.
constexpr double rounding_m = 1e-12 * 0.1;

static bool are_near(Vec2 a, Vec2 b, double margin = rounding_m) {
    return norm(a - b) <= margin;
}

TEST_CASE("every shape has unit speed along its tangent and returns to its start if it is closed",
          "[path]") {
    const std::vector<Vec2> points_m = {{-0.01, 0.0}, {0.03, 0.01}, {0.02, 0.04}};
    const std::vector<Curve> curves = {
        {{-0.01, 0.002}, {0.02, 0.03}},         Arc{{0.01, -0.02}, 0.015, 0.3, -2.0},
        Arc{{0.01, 0.0}, 0.015, 1.0, 2.0 * pi}, Polyline(points_m, Ends::open),
        Polyline(points_m, Ends::closed),       Lissajous({{}, {0.02, 0.01}, 3, 2, 0.4})};
    std::set<std::size_t> shapes;
    for (const Curve& path : curves) {
        CAPTURE(path.shape.index());
        shapes.insert(path.shape.index());
        const double length = length_m(path), h = 1e-5;
        const auto change = [&](double s, double by) {
            return point_m(path, s + by) - point_m(path, s - by);
        };
        for (int i = 0; i < 7; ++i) { // never across a corner
            const double s = length * (i + 0.41) / 7.0;
            CHECK(norm(tangent(path, s)) == Approx(1.0).epsilon(1e-14));
            // Radii of a few mm: the error of these differences is (h / r)^4, 1e-10.
            const Vec2 slope = (1.0 / (12.0 * h)) * (8.0 * change(s, h) - change(s, 2.0 * h));
            CHECK(are_near(slope, tangent(path, s), 1e-8));
        }
        const Vec2 end = point_m(path, length);
        CHECK(is_closed(path) == are_near(end, point_m(path, 0.0)));
        if (!is_closed(path))
            CHECK(are_near(point_m(path, length + 0.01), end + 0.01 * tangent(path, length)));
    }
    CHECK(shapes.size() == std::variant_size_v<decltype(Curve::shape)>);
}

TEST_CASE("an arc is run along by its angle", "[path]") {
    const double sign = GENERATE(1.0, -1.0);
    const Curve arc = Arc{{0.01, -0.02}, 0.015, 0.3, sign * 2.0};
    CHECK(length_m(arc) == Approx(0.03).epsilon(1e-15));
    for (const double s : {0.0, 0.004, 0.0171, 0.03}) {
        const double angle = 0.3 + sign * s / 0.015;
        CHECK(are_near(point_m(arc, s),
                       {0.01 + 0.015 * std::cos(angle), -0.02 + 0.015 * std::sin(angle)}));
    }
}

TEST_CASE("a circle has no corners, and one of radius 0 is its centre", "[path]") {
    CHECK(corners_m(Arc{{0.01, 0.0}, 0.015, 1.0, 2.0 * pi}).empty());
    const Curve point = Arc{{0.01, 0.0}, 0.0, 1.0, 2.0 * pi};
    CHECK(length_m(point) == 0.0);
    CHECK(point_m(point, 0.0) == Vec2{0.01, 0.0});
}

TEST_CASE("a polyline goes straight from point to point", "[path]") {
    const Polyline line({{0.0, 0.0}, {0.03, 0.0}, {0.03, 0.04}}, Ends::open);
    CHECK(line.length_m() == Approx(0.07).epsilon(1e-15));
    CHECK(are_near(line.at(0.01), {0.01, 0.0}));
    CHECK(are_near(line.at(0.05), {0.03, 0.02}));
    REQUIRE(line.corners_m().size() == 1);
    CHECK(line.corners_m()[0] == Approx(0.03).epsilon(1e-15));
}

TEST_CASE("a closed polyline returns to its first point", "[path]") {
    const Polyline triangle({{0.0, 0.0}, {0.03, 0.0}, {0.03, 0.04}}, Ends::closed);
    CHECK(triangle.length_m() == Approx(0.12).epsilon(1e-15));
    CHECK(are_near(triangle.at(0.095), {0.015, 0.02}));
    CHECK(triangle.corners_m().size() == 2);
    CHECK(triangle.starts_at_corner());
}

TEST_CASE("the points of a curve are not corners", "[path]") {
    const int sides = GENERATE(18, 17); // turns of 20 and 21.2 degrees are corners, 19 are not
    CHECK(regular_polygon({}, 0.01, sides, 0.0).corners_m().size() ==
          static_cast<std::size_t>(sides - 1));
    CHECK(regular_polygon({}, 0.01, 19, 0.0).corners_m().empty());
}

TEST_CASE("a Lissajous figure of equal parts is a circle", "[path]") {
    const Lissajous circle({{0.01, 0.0}, {0.015, 0.015}, 1, 1, 0.5 * pi});
    CHECK(circle.length_m() == Approx(2.0 * pi * 0.015).epsilon(1e-14));
    for (const double s : {0.0, 0.0123, 0.05, 0.09}) // from (a, 0) anticlockwise
        CHECK(are_near(circle.at(s),
                       {0.01 + 0.015 * std::cos(s / 0.015), 0.015 * std::sin(s / 0.015)}));
}

TEST_CASE("a Lissajous figure without phase is a line there and back", "[path]") {
    // The speed vanishes where it turns: the hardest case for the arc length.
    const Lissajous line({{}, {0.03, 0.04}, 1, 1, 0.0});
    CHECK(line.length_m() == Approx(0.2).epsilon(1e-14));
    for (const double s : {0.001, 0.049, 0.0499999, 0.0500001, 0.1, 0.15, 0.17}) {
        const double out = s < 0.05 ? s : s < 0.15 ? 0.1 - s : s - 0.2; // along (0.6, 0.8)
        CHECK(are_near(line.at(s), {0.6 * out, 0.8 * out}));
    }
}

TEST_CASE("a Lissajous figure has the arc length that summing finds", "[path]") {
    const Lissajous figure({{}, {0.02, 0.01}, 3, 2, 0.4});
    // The length of an inscribed polygon with steps h: error h^2, extrapolated once to h^4.
    const auto polygon = [&](int n) {
        double sum = 0.0;
        Vec2 before = {0.02 * std::sin(0.4), 0.0};
        for (int i = 1; i <= n; ++i) {
            const double theta = 2.0 * pi * i / n;
            const Vec2 here = {0.02 * std::sin(3.0 * theta + 0.4), 0.01 * std::sin(2.0 * theta)};
            sum += norm(here - before);
            before = here;
        }
        return sum;
    };
    const double expected = (4.0 * polygon(40000) - polygon(20000)) / 3.0;
    CHECK(figure.length_m() == Approx(expected).epsilon(1e-12));
}

} // namespace test_path
