// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/stress/grid_forces.hpp"

#include "engines/spectral/bodies/lump_markers.hpp"
#include "engines/spectral/bodies/stress/surface_patches.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_grid_forces {

using namespace shearwake;
using spectral::ForceStress;

namespace {

constexpr double lambda_per_mu = 1e5;

/// Force [N] through a cube around a unit force: its part along the force.
double force_through_cube(const Vec3& force_m, std::size_t along) {
    constexpr int n = 60;
    constexpr double cell = 2.0 / n;
    // The components of the traction on the faces across x, y and z.
    constexpr std::size_t of_face[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    double sum = 0.0;
    for (std::size_t face = 0; face < 3; ++face)
        for (const double side : {-1.0, 1.0})
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    double at[3];
                    at[face] = side;
                    at[(face + 1) % 3] = -1.0 + (i + 0.5) * cell;
                    at[(face + 2) % 3] = -1.0 + (j + 0.5) * cell;
                    const ForceStress k =
                        spectral::kelvin_stress(Vec3{at[0], at[1], at[2]} - force_m, lambda_per_mu);
                    sum += side * cell * cell * k[along][of_face[face][along]];
                }
    return sum;
}

} // namespace

TEST_CASE("stress of a point force in an infinite solid balances the force", "[grid_forces]") {
    for (std::size_t along = 0; along < 3; ++along) // midpoint rule: 1e-3
        CHECK(force_through_cube({0.2, -0.1, 0.3}, along) == Approx(-1.0).epsilon(2e-3));
}

TEST_CASE("stress of a force on the grid approaches that of a point force", "[grid_forces]") {
    constexpr double h = 0.5e-3;
    spectral::DepthMesh mesh;
    mesh.rule = spectral::gauss_lobatto(mesh.degree);
    for (int e = 0; e <= 8; ++e)
        mesh.ends_m.push_back(3e-3 * e);
    mesh.layers.assign(8, 0);
    // In elements that the forces do not touch; within these the stress alternates.
    const std::vector<double> force_m = {8e-3, 9e-3, 9.1e-3}, stress_m = {4.8e-3, 5.6e-3};
    const spectral::GridForces grid(mesh, h, lambda_per_mu, force_m, stress_m);
    for (std::size_t s = 0; s < stress_m.size(); ++s)
        for (std::size_t d = 0; d < force_m.size(); ++d)
            for (const std::ptrdiff_t x : {-5, 0, 3})
                for (const std::ptrdiff_t y : {-4, 0, 2}) {
                    const ForceStress found = grid.at(s, d, x, y);
                    const ForceStress exact = spectral::kelvin_stress({static_cast<double>(x) * h,
                                                                       static_cast<double>(y) * h,
                                                                       stress_m[s] - force_m[d]},
                                                                      lambda_per_mu);
                    double difference = 0.0, largest = 0.0;
                    for (std::size_t f = 0; f < 3; ++f)
                        for (std::size_t c = 0; c < exact[f].size(); ++c) {
                            difference = std::max(difference, std::abs(found[f][c] - exact[f][c]));
                            largest = std::max(largest, std::abs(exact[f][c]));
                        }
                    CAPTURE(s, d, x, y);
                    // The images 64 spacings away and the ends of the mesh contribute 3.6 %.
                    CHECK(difference < 0.04 * largest);
                }
}

TEST_CASE("patches of markers carry the forces of their markers", "[grid_forces]") {
    const Domain domain{.nx = 64, .ny = 64, .spacing_m = 0.5e-3};
    Body body{.name = "bone", .shape = Ellipsoid{{3e-3, 2.5e-3, 2e-3}}, .centre_m = {0, 0, 9e-3}};
    double area_m2 = 0.0;
    SECTION("ellipsoid") {
        area_m2 = 78.132e-6; // numerical integral
    }
    SECTION("box") {
        body.shape = Box{{4e-3, 3e-3, 2e-3}};
        area_m2 = 2.0 * (12e-6 + 8e-6 + 6e-6);
    }
    SECTION("cylinder") {
        body.shape = Cylinder{.radius_m = 2e-3, .length_m = 5e-3, .azimuth_deg = 30.0};
        area_m2 = 2.0 * std::numbers::pi * 2e-3 * (2e-3 + 5e-3);
    }
    double sum_m2 = 0.0;
    for (const auto& point : spectral::surface_points(body, domain, 0.2e-3)) {
        sum_m2 += point.area_m2;
        CHECK(norm(point.normal) == Approx(1.0));
        const Vec3 at = body.centre_m + point.offset_m;
        CHECK(volume_fraction(body, at + 1e-5 * point.normal, {}) < 0.5);
        CHECK(volume_fraction(body, at - 1e-5 * point.normal, {}) > 0.5);
    }
    CHECK(sum_m2 == Approx(area_m2).epsilon(2e-3)); // midpoint rule
    std::vector<spectral::PatchedMarker> markers;
    for (const Vec3& offset_m : spectral::lump_markers(body, domain, 0.5e-3))
        markers.push_back({0, offset_m});
    std::vector<double> weight(markers.size(), 0.0);
    const spectral::PatchedBody patched{
        body.centre_m, spectral::surface_points(body, domain, 0.2e-3), spectral::curved_inset};
    for (const auto& point :
         spectral::surface_patches({patched}, markers, domain.spacing_m, spectral::patch_ring)
             .points)
        for (const auto& share : point.shares)
            weight[share.marker] += share.weight;
    for (const double sum : weight)
        CHECK(sum == Approx(1.0)); // rounding
}

} // namespace test_grid_forces
