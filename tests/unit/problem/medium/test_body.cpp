// SPDX-License-Identifier: BSD-3-Clause
#include "problem/medium/body.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>

namespace test_body {

using namespace shearwake;

constexpr double pi = std::numbers::pi;

/// Cells of 1 mm, 1 mm and 0.7 mm around (and a little beside) the origin.
struct Grid {
    int nx = 24, ny = 24, nz = 30;
    Vec3 size_m{1e-3, 1e-3, 0.7e-3};
    Vec3 shift_m{};

    Vec3 centre_m(int i, int j, int k) const {
        return shift_m + Vec3{(i + 0.5 - 0.5 * nx) * size_m.x, (j + 0.5 - 0.5 * ny) * size_m.y,
                              (k + 0.5 - 0.5 * nz) * size_m.z};
    }
};

static double summed_volume_m3(const Body& body, const Grid& grid) {
    double sum = 0.0;
    for (int i = 0; i < grid.nx; ++i)
        for (int j = 0; j < grid.ny; ++j)
            for (int k = 0; k < grid.nz; ++k)
                sum += volume_fraction(body, grid.centre_m(i, j, k), grid.size_m);
    return sum * grid.size_m.x * grid.size_m.y * grid.size_m.z;
}

static Body cylinder(double length_m, double azimuth_deg, double edge_m = 0.0) {
    return {.shape = Cylinder{.radius_m = 3e-3, .length_m = length_m, .azimuth_deg = azimuth_deg},
            .centre_m = {0.2e-3, -0.3e-3, 0.1e-3},
            .edge_m = edge_m};
}

/// The same body seen in a mirror at x = 0.
static Body mirrored(Body body) {
    body.centre_m.x = -body.centre_m.x;
    if (auto* c = std::get_if<Cylinder>(&body.shape)) c->azimuth_deg = -c->azimuth_deg;
    return body;
}

TEST_CASE("the shares of all cells add up to the body's volume", "[body]") {
    const Grid grid;
    const double edge_m = GENERATE(0.0, 1.5e-3);
    const Vec3 centre_m{0.2e-3, -0.3e-3, 0.1e-3};
    // An edge puts as much outside of a round face as it takes from the inside, but further out:
    // integral of 2 r s(r) = R^2 + m w^2 with the profile's second moment m (by quadrature).
    const double edge_gain = 1.0 + 0.03625 * std::pow(edge_m / 3e-3, 2);
    SECTION("a box, exactly when its faces are sharp: each share is a product of lengths") {
        const Body body{
            .shape = Box{{5.3e-3, 4.1e-3, 3.7e-3}}, .centre_m = centre_m, .edge_m = edge_m};
        // Smooth: an odd profile loses nothing, but is summed at 4 points a cell; measured 7e-5.
        CHECK(summed_volume_m3(body, grid) ==
              Approx(5.3e-3 * 4.1e-3 * 3.7e-3).epsilon(edge_m > 0.0 ? 2e-4 : 1e-12));
    }
    SECTION("an ellipsoid") {
        const Body body{
            .shape = Ellipsoid{{5e-3, 4e-3, 3e-3}}, .centre_m = centre_m, .edge_m = edge_m};
        // Sharp: planar sub-samples of an eighth of a cell; measured 5e-4. Smooth: the distance is
        // approximate and the face curved; a sphere of 4 mm would gain 0.109 (1.5 / 4)^2 = 1.5 %.
        CHECK(summed_volume_m3(body, grid) ==
              Approx(4.0 / 3.0 * pi * 5e-3 * 4e-3 * 3e-3).epsilon(edge_m > 0.0 ? 2e-2 : 1e-3));
    }
    SECTION("a cylinder along x, along y, between, and upright") {
        const double azimuth_deg = GENERATE(0.0, 90.0, 30.0, -77.0);
        Body body = cylinder(8e-3, azimuth_deg, edge_m);
        if (azimuth_deg == 0.0 && GENERATE(false, true))
            std::get<Cylinder>(body.shape).axis = CylinderAxis::vertical;
        // The planar sub-samples: measured 3e-4.
        CHECK(summed_volume_m3(body, grid) == Approx(pi * 9e-6 * 8e-3 * edge_gain).epsilon(5e-4));
    }
}

TEST_CASE("mirrored bodies give mirrored shares", "[body]") {
    const Grid grid;
    const double edge_m = GENERATE(0.0, 2e-3);
    const Body body = GENERATE_COPY(
        cylinder(7e-3, 33.0, edge_m), cylinder(0.0, -12.0, edge_m),
        Body{.shape = Ellipsoid{{5e-3, 4e-3, 3e-3}}, .centre_m = {1e-3, 0, 0}, .edge_m = edge_m},
        Body{.shape = Box{{5e-3, 4e-3, 3e-3}}, .centre_m = {0.7e-3, 0, 0}, .edge_m = edge_m});
    double worst = 0.0;
    for (int i = 0; i < grid.nx; ++i)
        for (int j = 0; j < grid.ny; ++j)
            for (int k = 0; k < grid.nz; ++k)
                worst = std::max(
                    worst,
                    std::abs(volume_fraction(body, grid.centre_m(i, j, k), grid.size_m) -
                             volume_fraction(mirrored(body), grid.centre_m(grid.nx - 1 - i, j, k),
                                             grid.size_m)));
    // Sums of 512 terms in another order.
    CHECK(worst < 1e-13);
}

TEST_CASE("a quarter turn of a cylinder is a quarter turn of its shares", "[body]") {
    const Body along_x = cylinder(7e-3, 0.0), along_y = cylinder(7e-3, 90.0);
    const Vec3 size_m{1e-3, 1e-3, 0.7e-3};
    for (const double u_m : {0.1e-3, 2.9e-3, 3.4e-3})
        for (const double v_m : {0.4e-3, 2.2e-3, 3.1e-3}) {
            const Vec3 c = along_x.centre_m;
            CHECK(
                volume_fraction(along_x, c + Vec3{u_m, v_m, 1e-3}, size_m) ==
                Approx(volume_fraction(along_y, c + Vec3{-v_m, u_m, 1e-3}, size_m)).margin(1e-13));
        }
}

TEST_CASE("an infinite cylinder is unbounded, and so are its bounds", "[body]") {
    const double length_m = GENERATE(0.0, std::numeric_limits<double>::infinity());
    const Body body = cylinder(length_m, 0.0);
    const Vec3 size_m{1e-3, 1e-3, 1e-3};
    CHECK(volume_fraction(body, {5.0, -0.3e-3, 0.1e-3}, size_m) == 1.0);
    CHECK(std::isinf(bounds(body).high_m.x));
    CHECK(bounds(body).high_m.y == Approx(2.7e-3));
    CHECK(bounds(body).low_m.z == Approx(-2.9e-3));
}

TEST_CASE("the fraction is 0 outside the bounds and 1 well inside", "[body]") {
    const double edge_m = GENERATE(0.0, 1e-3, 2.9e-3);
    const Body body =
        GENERATE_COPY(cylinder(7e-3, 33.0, edge_m),
                      Body{.shape = Ellipsoid{{6e-3, 4e-3, 1.5e-3}}, .edge_m = edge_m},
                      Body{.shape = Box{{5e-3, 4e-3, 3e-3}}, .edge_m = edge_m});
    const Bounds box = bounds(body);
    const Vec3 point{}; // a cell without size: the profile itself
    const Vec3 middle = 0.5 * (box.low_m + box.high_m);
    CHECK(volume_fraction(body, middle, point) == 1.0);
    for (double s = -1.0; s <= 1.0; s += 0.05)
        for (double t = -1.0; t <= 1.0; t += 0.05) {
            const Vec3 half = (1.0 + 1e-9) * (box.high_m - middle);
            // The share must have died out by itself: just within is as good as nothing.
            const Vec3 side{(1.0 - 1e-6) * half.x, s * half.y, t * half.z};
            if (edge_m > 0.0) CHECK(volume_fraction(body, middle + side, point) < 1e-6);
            CHECK(volume_fraction(body, middle + Vec3{s * half.x, half.y, t * half.z}, point) == 0);
        }
}

TEST_CASE("an edge is smooth and 1/2 at the face", "[body]") {
    const Body body{.shape = Box{{10e-3, 10e-3, 10e-3}}, .edge_m = 2e-3};
    const auto share = [&](double x_m) { return volume_fraction(body, {x_m, 0, 0}, {}); };
    CHECK(share(5e-3) == Approx(0.5).epsilon(1e-12));
    CHECK(share(4e-3) == 1.0);
    CHECK(share(6e-3) == 0.0);
    for (const double d_m : {0.1e-3, 0.5e-3, 0.9e-3}) {
        CHECK(share(5e-3 - d_m) + share(5e-3 + d_m) == Approx(1.0).epsilon(1e-12));
        CHECK(share(5e-3 - d_m) > share(5e-3 + d_m));
    }
    // All derivatives vanish at the ends: the tenth of a per mille of the width before the end
    // holds less than any power of it would.
    CHECK(share(6e-3 - 1e-4) < 1e-4);
    CHECK(share(6e-3 - 2e-5) < 1e-40);
}

} // namespace test_body
