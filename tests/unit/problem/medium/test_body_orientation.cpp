// SPDX-License-Identifier: BSD-3-Clause
#include "problem/medium/body.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace test_body_orientation {

using namespace shearwake;

constexpr double pi = std::numbers::pi;
constexpr Vec3 centre_m{0.2e-3, -0.3e-3, 0.1e-3};
constexpr Vec3 cell_m{1e-3, 1e-3, 0.7e-3};

static double dot(Vec3 a, Vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Calls use(centre) for cells of 1 mm, 1 mm and 0.7 mm around the origin.
template <class Use>
void each_cell(const Use& use) {
    for (int i = -12; i < 12; ++i)
        for (int j = -12; j < 12; ++j)
            for (int k = -17; k < 17; ++k)
                use(Vec3{(i + 0.5) * cell_m.x, (j + 0.5) * cell_m.y, (k + 0.5) * cell_m.z});
}

static double summed_volume_m3(const Body& body) {
    double sum = 0.0;
    each_cell([&](Vec3 at) { sum += volume_fraction(body, at, cell_m); });
    return sum * cell_m.x * cell_m.y * cell_m.z;
}

/// The largest difference of the fractions of any cell.
static double difference(const Body& a, const Body& b) {
    double worst = 0.0;
    each_cell([&](Vec3 at) {
        worst = std::max(worst,
                         std::abs(volume_fraction(a, at, cell_m) - volume_fraction(b, at, cell_m)));
    });
    return worst;
}

static Body body_of(decltype(Body::shape) shape, double edge_m = 0.0) {
    return {.shape = shape, .centre_m = centre_m, .edge_m = edge_m};
}

TEST_CASE("an orientation is a rotation", "[body]") {
    const double azimuth_deg = GENERATE(0.0, 33.0, -90.0, 200.0);
    const double inclination_deg = GENERATE(0.0, -90.0, 17.0);
    const double roll_deg = GENERATE(0.0, 180.0, 71.0);
    const BodyAxes f = axes_of(Orientation{azimuth_deg, inclination_deg, roll_deg});
    for (const Vec3 axis : {f.x, f.y, f.z})
        CHECK(norm(axis) == Approx(1.0).epsilon(1e-15));
    CHECK(std::abs(dot(f.x, f.y)) < 1e-15);
    CHECK(std::abs(dot(f.y, f.z)) < 1e-15);
    const Vec3 cross{f.x.y * f.y.z - f.x.z * f.y.y, f.x.z * f.y.x - f.x.x * f.y.z,
                     f.x.x * f.y.y - f.x.y * f.y.x};
    CHECK(norm(cross - f.z) < 1e-15); // not a mirror image
    const Vec3 v{0.3, -0.7, 0.2};
    CHECK(norm(f.to_body(f.to_medium(v)) - v) < 1e-15);
}

TEST_CASE("the angles of an orientation have the documented directions", "[body]") {
    CHECK(axes_of(Orientation{}) == BodyAxes{});
    CHECK(axes_of(Orientation{.azimuth_deg = 90.0}).x == Vec3{0.0, 1.0, 0.0});
    CHECK(axes_of(Orientation{.azimuth_deg = 10.0, .inclination_deg = 90.0}).x ==
          Vec3{0.0, 0.0, 1.0});
    CHECK(axes_of(Orientation{.inclination_deg = 30.0}).x.z == Approx(0.5));
    CHECK(axes_of(Orientation{.roll_deg = 90.0}).y == Vec3{0.0, 0.0, 1.0});
    CHECK(axes_of(Orientation{.azimuth_deg = 360.0, .roll_deg = -360.0}) == BodyAxes{});
}

TEST_CASE("a turned body has the volume of its shape", "[body]") {
    const Orientation turn = GENERATE(Orientation{25.0, 0.0, 0.0}, Orientation{0.0, 35.0, 0.0},
                                      Orientation{-70.0, -50.0, 40.0});
    SECTION("box") {
        // Sub-samples of an eighth of a cell are planar, so only those at the edges of the box are
        // in error; measured 8e-4.
        CHECK(summed_volume_m3(body_of(Box{{7e-3, 4e-3, 3e-3}, turn})) ==
              Approx(7e-3 * 4e-3 * 3e-3).epsilon(2e-3));
    }
    SECTION("ellipsoid") {
        // As without orientation (test_body.cpp).
        CHECK(summed_volume_m3(body_of(Ellipsoid{{5e-3, 4e-3, 3e-3}, turn})) ==
              Approx(4.0 / 3.0 * pi * 5e-3 * 4e-3 * 3e-3).epsilon(1e-3));
    }
    SECTION("cylinder") {
        CHECK(summed_volume_m3(body_of(Cylinder{.radius_m = 3e-3,
                                                .length_m = 8e-3,
                                                .azimuth_deg = turn.azimuth_deg,
                                                .inclination_deg = turn.inclination_deg})) ==
              Approx(pi * 9e-6 * 8e-3).epsilon(2e-3)); // edges, as those of boxes
    }
}

TEST_CASE("a quarter turn exchanges the sizes of a body", "[body]") {
    const double edge_m = GENERATE(0.0, 1.2e-3);
    struct Turn {
        Orientation by;
        Vec3 size;
    };
    const Vec3 r{5e-3, 4e-3, 3e-3};
    const Turn turn = GENERATE_COPY(
        Turn{{90.0, 0.0, 0.0}, {r.y, r.x, r.z}}, Turn{{0.0, 90.0, 0.0}, {r.z, r.y, r.x}},
        Turn{{0.0, 0.0, -90.0}, {r.x, r.z, r.y}}, Turn{{180.0, 0.0, 180.0}, r},
        Turn{{-90.0, -90.0, 0.0}, {r.y, r.z, r.x}});
    const Body box = body_of(Box{r, turn.by}, edge_m), plain_box = body_of(Box{turn.size}, edge_m);
    // Products of three factors in another order.
    CHECK(difference(box, plain_box) < 1e-14);
    CHECK(bounds(box) == bounds(plain_box));
    CHECK(lateral_thickness_m(box) == lateral_thickness_m(plain_box));
    CHECK(thickness_m(box) == thickness_m(plain_box));
    const Body ball = body_of(Ellipsoid{r, turn.by}, edge_m),
               plain_ball = body_of(Ellipsoid{turn.size}, edge_m);
    // Norms of three components in another order, in up to 512 sub-samples.
    CHECK(difference(ball, plain_ball) < 1e-12);
    CHECK(bounds(ball) == bounds(plain_ball));
    CHECK(lateral_thickness_m(ball) == lateral_thickness_m(plain_ball));
    CHECK(thickness_m(ball) == thickness_m(plain_ball));
}

TEST_CASE("a cylinder inclined by 90 degrees is vertical", "[body]") {
    const double edge_m = GENERATE(0.0, 1.2e-3);
    const Body vertical = body_of(
        Cylinder{.radius_m = 3e-3, .length_m = 8e-3, .axis = CylinderAxis::vertical}, edge_m);
    const Body inclined = body_of(
        Cylinder{.radius_m = 3e-3, .length_m = 8e-3, .inclination_deg = GENERATE(90.0, -90.0)},
        edge_m);
    CHECK(difference(inclined, vertical) < 1e-12); // rounding in up to 512 sub-samples
    CHECK(bounds(inclined) == bounds(vertical));
    CHECK(lateral_thickness_m(inclined) == lateral_thickness_m(vertical));
}

TEST_CASE("the bounds of a turned body touch it on each side", "[body]") {
    const double edge_m = GENERATE(0.0, 0.8e-3);
    const Orientation turn{-70.0, -50.0, 40.0};
    const Body body = GENERATE_COPY(body_of(Box{{7e-3, 4e-3, 3e-3}, turn}, edge_m),
                                    body_of(Ellipsoid{{5e-3, 4e-3, 3e-3}, turn}, edge_m),
                                    body_of(Cylinder{.radius_m = 2e-3,
                                                     .length_m = 9e-3,
                                                     .azimuth_deg = 30.0,
                                                     .inclination_deg = 50},
                                            edge_m));
    const Bounds box = bounds(body);
    const Vec3 half = 0.5 * (box.high_m - box.low_m);
    // Each plane at the ends of the bounds, and at 93 % of them: a cone with the apex of a box at
    // the end is 7 % of the reach, several samples, wide there.
    constexpr int samples = 120;
    const auto greatest = [&](int axis, double at) {
        double most = 0.0;
        for (int i = 0; i <= samples; ++i)
            for (int j = 0; j <= samples; ++j) {
                const double u = 2.0 * i / samples - 1.0, v = 2.0 * j / samples - 1.0;
                const Vec3 unit = axis == 0   ? Vec3{at, u, v}
                                  : axis == 1 ? Vec3{v, at, u}
                                              : Vec3{u, v, at};
                const Vec3 p{unit.x * half.x, unit.y * half.y, unit.z * half.z};
                most = std::max(most, volume_fraction(body, body.centre_m + p, {}));
            }
        return most;
    };
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            CHECK(greatest(axis, side * (1.0 + 1e-9)) == 0.0);
            if (edge_m == 0.0) CHECK(greatest(axis, 0.93 * side) > 0.0);
        }
}

TEST_CASE("the lateral thickness of a turned body is that of its horizontal section", "[body]") {
    const auto width_m = [](decltype(Body::shape) shape) {
        return lateral_thickness_m(body_of(shape));
    };
    const double tilt = 30.0 * pi / 180.0;
    // A plate of 1 mm that is inclined by 30 degrees is 2 mm wide in a horizontal plane.
    CHECK(width_m(Box{{9e-3, 8e-3, 1e-3}, {.inclination_deg = 30.0}}) ==
          Approx(1e-3 / std::sin(tilt)));
    CHECK(width_m(Box{{9e-3, 8e-3, 20e-3}, {.azimuth_deg = 30.0}}) == Approx(8e-3));
    CHECK(width_m(Cylinder{.radius_m = 3e-3, .length_m = 2e-3, .inclination_deg = 30.0}) ==
          Approx(2e-3 / std::cos(tilt)));
    const double a = 5e-3, c = 1e-3; // the section across y: its half width along x
    CHECK(width_m(Ellipsoid{{a, 4e-3, c}, {.inclination_deg = 30.0}}) ==
          Approx(2.0 / std::hypot(std::cos(tilt) / a, std::sin(tilt) / c)));
    CHECK(width_m(Ellipsoid{{a, 4e-3, c}, {.azimuth_deg = 77.0, .inclination_deg = 30.0}}) ==
          Approx(2.0 / std::hypot(std::cos(tilt) / a, std::sin(tilt) / c)));
}

} // namespace test_body_orientation
