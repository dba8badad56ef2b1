// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/spectral/depth/mesh_pieces.hpp"
#include "engines/spectral/stepping/time_step.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>

namespace test_mesh_pieces {

using namespace shearwake;

static Case two_layers() {
    Case c = test::moving_focus(test::half_space(test::tissue(1500.0, 1.0)), ConstantSpeed{7.0});
    c.scene.medium.base = Base::rigid;
    c.scene.medium.layers.assign(2, c.scene.medium.layers[0]);
    c.scene.medium.layers[0].thickness_m = 2e-3;
    c.scene.medium.layers[1].thickness_m = 10e-3;
    return c;
}

static Body box(double top_m, double bottom_m) {
    return {.name = "box",
            .shape = Box{{5e-3, 5e-3, bottom_m - top_m}},
            .centre_m = {0.0, 0.0, 0.5 * (top_m + bottom_m)},
            .c_s_m_s = 10.0};
}

static std::vector<double> ends_m(const Case& c) {
    std::vector<double> ends = {0.0};
    for (const spectral::MeshPiece& piece : spectral::mesh_pieces(c, 12e-3, 0.05e-3, 8, 6e3)) {
        CHECK(piece.top_m == ends.back());
        ends.push_back(piece.bottom_m);
    }
    return ends;
}

TEST_CASE("layers are divided at the tops and bottoms of sharp bodies", "[spectral]") {
    Case c = two_layers();
    CHECK(ends_m(c) == std::vector{0.0, 2e-3, 12e-3});
    c.scene.medium.bodies = {box(1e-3, 5e-3)};
    const auto ends = ends_m(c);
    REQUIRE(ends.size() == 5);
    CHECK(ends[1] == Approx(1e-3));
    CHECK(ends[3] == Approx(5e-3));
    c.scene.medium.bodies = {box(1.97e-3, 11.99e-3)}; // too close for a separate element
    CHECK(ends_m(c) == std::vector{0.0, 2e-3, 12e-3});
    c.scene.medium.bodies = {box(-1e-3, 20e-3)}; // beyond both ends of the layer
    CHECK(ends_m(c) == std::vector{0.0, 2e-3, 12e-3});
    c.scene.medium.bodies = {box(1e-3, 5e-3)};
    c.scene.medium.bodies[0].edge_m = 1e-3; // smooth
    CHECK(ends_m(c) == std::vector{0.0, 2e-3, 12e-3});
}

TEST_CASE("elements are shortened only where a body requires it", "[spectral]") {
    Case c = two_layers();
    c.scene.medium.bodies = {box(4e-3, 8e-3)};
    const auto longest_at = [&](double z_m) {
        for (const spectral::MeshPiece& piece : spectral::mesh_pieces(c, 12e-3, 0.05e-3, 8, 6e3))
            if (piece.top_m < z_m && z_m < piece.bottom_m) return piece.longest_m;
        return 0.0;
    };
    CHECK(longest_at(6e-3) > 12e-3); // horizontal faces
    c.scene.medium.bodies[0].shape = Ellipsoid{{5e-3, 5e-3, 2e-3}};
    CHECK(longest_at(6e-3) == Approx(4e-3 / spectral::elements_of_body));
    CHECK(longest_at(10e-3) > 12e-3);
    c.scene.medium.bodies[0].c_s_m_s = 0.15; // wavelength of 0.15/6e3 m per radian
    CHECK(longest_at(6e-3) == Approx(0.5e-3));
    SpectralOptions options;
    options.time_step_s = 25e-6;
    c.solver = options;
    const spectral::DepthMesh mesh = spectral::choose_mesh(c, options);
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        CAPTURE(e, mesh.ends_m[e], mesh.ends_m[e + 1]);
        const bool within = mesh.ends_m[e] > 3.999e-3 && mesh.ends_m[e + 1] < 8.001e-3;
        const bool outside = mesh.ends_m[e + 1] < 4.001e-3 || mesh.ends_m[e] > 7.999e-3;
        CHECK((within || outside));
        if (within) CHECK(mesh.length_m(e) < 1e-3);
    }
}

TEST_CASE("layers are divided at the ends of a map and at least at every eighth of its points",
          "[spectral]") {
    Case c = two_layers();
    auto map = std::make_shared<MaterialMap>();
    map->counts = {1, 1, 11};
    map->origin_m = {0.0, 0.0, 3e-3};
    map->spacing_m = {0.0, 0.0, 0.2e-3};
    c.scene.medium.map = map;
    const auto ends = ends_m(c);
    REQUIRE(ends.size() == 5);
    CHECK(ends[2] == Approx(2.9e-3));
    CHECK(ends[3] == Approx(5.1e-3));
    CHECK(spectral::mesh_pieces(c, 12e-3, 0.05e-3, 8, 6e3)[2].longest_m == Approx(1.6e-3));
}

TEST_CASE("a box is divided as a curved body if its faces are inclined", "[spectral]") {
    Case c = two_layers();
    const auto pieces = [&](Orientation orientation) {
        Body body = box(4e-3, 9e-3);
        std::get<Box>(body.shape).orientation = orientation;
        c.scene.medium.bodies = {body};
        return spectral::mesh_pieces(c, 12e-3, 0.05e-3, 8, 1.0)[2];
    };
    const double plain_m = pieces({}).longest_m;
    CHECK(pieces({.azimuth_deg = 30.0}).longest_m == plain_m);
    CHECK(pieces({.roll_deg = 90.0}).longest_m == plain_m);
    CHECK(pieces({.inclination_deg = 30.0}).longest_m < plain_m);
}

} // namespace test_mesh_pieces
