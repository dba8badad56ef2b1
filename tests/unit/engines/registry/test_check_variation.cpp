// SPDX-License-Identifier: BSD-3-Clause
#include "engines/engine.hpp"
#include "engines/registry/check.hpp"
#include "engines/registry/make_engine.hpp"
#include "unit/engines/registry/remarks.hpp"

#include <catch2/catch.hpp>

namespace test_check_variation {

using namespace shearwake;

/// A ball of 4 mm in 96 x 67.5 mm: nothing to remark.
static Case good_case() {
    Case c;
    c.scene.medium.layers = {
        {.name = "tissue", .thickness_m = 0.02, .density_kg_m3 = 1e3, .c_p_m_s = 50, .c_s_m_s = 5}};
    c.scene.medium.bodies = {{.shape = Ellipsoid{{2e-3, 2e-3, 2e-3}}, .centre_m = {0, 0, 5e-3}}};
    c.domain = {.nx = 128, .ny = 90, .spacing_m = 0.00075};
    c.time = {20, 100e-6};
    c.solver = SpectralOptions{};
    return c;
}

/// What is said of bodies and maps, by the engine and by the check.
static std::vector<Remark> remarks_on(const Case& c) {
    std::vector<Remark> remarks = engines::make_engine(c.solver)->limits(c);
    for (const Remark& remark : check_variation(c))
        remarks.push_back(remark);
    return remarks;
}

static void warns(const Case& c, std::string_view key, const auto&... texts) {
    test::check_remark(remarks_on(c), Severity::warning, key, {texts...});
}

static void rejects(const Case& c, std::string_view key, const auto&... texts) {
    test::check_remark(remarks_on(c), Severity::error, key, {texts...});
}

/// A map over `half_x_m` about the origin and the whole of y and z.
static std::shared_ptr<const MaterialMap> map_over(double half_x_m, double middle_m = 0.0) {
    MaterialMap map{.counts = {3, 1, 1},
                    .origin_m = {middle_m - 2.0 / 3.0 * half_x_m, 0, 0},
                    .spacing_m = {2.0 / 3.0 * half_x_m, 0, 0},
                    .c_s_m_s = {5, 6, 7}};
    return std::make_shared<const MaterialMap>(map);
}

TEST_CASE("a body well inside has no remark", "[check_variation]") {
    CHECK(remarks_on(good_case()).empty());
}

TEST_CASE("the layered engine rejects bodies and maps with their keys", "[check_variation]") {
    Case c = good_case();
    c.solver = LayeredOptions{};
    rejects(c, "medium.body", "solver.engine = \"spectral\"");
    c.scene.medium.bodies.clear();
    CHECK(remarks_on(c).empty());
    c.scene.medium.map = map_over(1.0);
    rejects(c, "medium.map");
}

TEST_CASE("only the engine pstd supports a fluid body", "[check_variation]") {
    Case c = good_case();
    c.scene.medium.bodies[0].c_s_m_s = 0.0;
    c.solver = SpectralOptions{};
    rejects(c, "medium.body[1].c_s_m_s");
    PstdOptions pstd;
    pstd.top = PstdTop::continued; // without the error of a free surface
    c.solver = pstd;
    CHECK(remarks_on(c).empty());
}

TEST_CASE("a body that the grid does not resolve is reported with numbers", "[check_variation]") {
    Case c = good_case();
    c.scene.medium.bodies.push_back(
        {.shape = Cylinder{.radius_m = 0.5e-3, .length_m = 20e-3}, .centre_m = {0, 0, 5e-3}});
    warns(c, "medium.body[2].shape",
          "1 mm wide along the surface and the spacing is 0.75 mm, which gives 1.3 ");
    c.scene.medium.bodies[1].shape = Box{{10e-3, 10e-3, 0.1e-3}}; // thin in depth only
    CHECK(remarks_on(c).empty());
}

TEST_CASE("the error of a body that the grid hardly resolves depends on its stiffness",
          "[check_variation]") {
    Case c = good_case();
    Body& body = c.scene.medium.bodies[0];
    body.shape = Ellipsoid{{3e-3, 3e-3, 3e-3}}; // 4 spacings per radius
    body.c_s_m_s = 5.0 * std::sqrt(10.0);
    CHECK(remarks_on(c).empty());
    body.c_s_m_s = 5.0 * std::sqrt(400.0);
    body.c_p_m_s = 1500.0;
    warns(c, "medium.body[1].shape",
          "error by about 6.2 % at a width of 8 spacings and 3 % at 15; use "
          "domain.spacing_mm = 0.4");
    body.c_s_m_s = 5.0 * std::sqrt(2000.0);
    warns(c, "",
          "it is 8 grid spacings wide along the surface and rigid: the waves that a body "
          "scatters are then in error by about 8.2 % at a width of 8 spacings and 2.3 % at 12");
    body.shape = Ellipsoid{{2.4e-3, 3e-3, 3e-3}}; // 3.2 spacings per radius
    warns(c, "", "16 % at a width of 6 spacings and 2.3 % at 12");
    body.shape = Cylinder{.radius_m = 3e-3};
    CHECK(remarks_on(c).empty()); // 2.9 %
    body.shape = Ellipsoid{{1.2e-3, 2e-3, 2e-3}};
    body.c_s_m_s = 5.0 * std::sqrt(10.0);
    warns(c, "",
          "error by about 7.2 % at a width of 2 spacings and 2.7 % at 4; "
          "use domain.spacing_mm = 0.6");
}

TEST_CASE("the engine pstd needs more points across a body than spectral", "[check_variation]") {
    Case c = good_case();
    c.scene.medium.bodies[0].shape = Ellipsoid{{1.5e-3, 2e-3, 2e-3}}; // 3 mm: 4 points
    CHECK(remarks_on(c).empty());
    PstdOptions pstd;
    pstd.top = PstdTop::continued; // without the error of a free surface
    c.solver = pstd;
    warns(c, "medium.body[1].shape", "it is 4 grid spacings wide along the surface",
          "domain.spacing_mm = 0.375");
}

TEST_CASE("a body that crosses the edge of the domain is reported", "[check_variation]") {
    Case c = good_case();
    SECTION("cut off") {
        c.scene.medium.bodies[0].centre_m.x = -47e-3;
        warns(c, "medium.body[1].center_mm",
              "it reaches 49 mm along x, but the domain ends at 48 mm: its last 1 mm are cut off");
        c.scene.medium.bodies[0].name = "bone";
        warns(c, "", "\"bone\" reaches 49 mm along x");
        c.scene.medium.bodies[0].name = "body 1"; // the default
        warns(c, "", "it reaches 49 mm along x");
    }
    SECTION("a rigid body continues at the opposite edge") {
        c.scene.medium.bodies[0] = {.shape = Cylinder{.radius_m = 3e-3, .azimuth_deg = 90.0},
                                    .centre_m = {47e-3, 0.0, 5e-3},
                                    .rigid = true};
        CHECK(remarks_on(c).empty());
    }
    SECTION("a box as wide as the domain has no ends") {
        c.scene.medium.bodies[0].shape = Box{{6e-3, 1.0, 6e-3}};
        c.domain.sponge_m = 5e-3;
        CHECK(remarks_on(c).empty());
        c.scene.medium.bodies[0].rigid = true;
        CHECK(remarks_on(c).empty());
    }
    SECTION("its smooth edge counts") {
        c.scene.medium.bodies[0].centre_m.x = 45.5e-3;
        c.scene.medium.bodies[0].edge_m = 2e-3;
        warns(c, "", "it reaches 48.5 mm along x");
    }
    SECTION("in the margin") {
        c.domain.sponge_m = 5e-3;
        c.scene.medium.bodies[0].centre_m.y = 30e-3;
        warns(c, "",
              "it reaches 32 mm along y and thus into the margin domain.sponge_mm, 5 mm wide, "
              "at the edge of the domain at 33.75 mm");
    }
    SECTION("outside") {
        c.scene.medium.bodies[0].centre_m.y = 36e-3;
        rejects(c, "", "has no effect: it extends from 34 to 38 mm along y");
    }
}

TEST_CASE("an infinite cylinder must match itself at the periodic edges", "[check_variation]") {
    Case c = good_case();
    Cylinder bone{.radius_m = 3e-3, .azimuth_deg = 90.0};
    c.scene.medium.bodies[0].shape = bone;
    CHECK(remarks_on(c).empty());
    bone.azimuth_deg = 30.0;
    c.scene.medium.bodies[0].shape = bone;
    warns(c, "medium.body[1].azimuth_deg", "at an angle of 30 degrees");
    c.scene.medium.bodies[0].shape = Cylinder{.radius_m = 3e-3, .axis = CylinderAxis::vertical};
    CHECK(remarks_on(c).empty());
}

TEST_CASE("a map that does not cover the domain is reported", "[check_variation]") {
    Case c = good_case();
    c.scene.medium.map = map_over(48e-3);
    CHECK(remarks_on(c).empty());
    c.scene.medium.map = map_over(30e-3);
    warns(c, "medium.map", "it covers x from -30 to 30, y from");
    c.scene.medium.map = map_over(30e-3, 90e-3);
    rejects(c, "", "no part of the domain");
    c.scene.medium.map = map_over(30.0); // mm
    warns(c, "", "are its coordinates in m?");
}

} // namespace test_check_variation
