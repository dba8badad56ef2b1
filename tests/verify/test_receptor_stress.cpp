// SPDX-License-Identifier: BSD-3-Clause
// The stress of engine "spectral" at receptors, compared with the exact engine, with the volumes of
// the same engine, and with the balance of forces.
#include "support/orders.hpp"
#include "support/spectral_cases.hpp"
#include "support/stress_store.hpp"
#include "support/volume_store.hpp"

#include <catch2/catch.hpp>

namespace test_receptor_stress {

using namespace shearwake;
using test::relative_l2;
using test::with_step;

constexpr std::size_t receptors = 3; // at depths of 0.3, 1.6 and 2 mm

/// A 3 mm focus at 7 m/s over skin of 1.2 mm and 7 mm of softer tissue on a rigid base. It is
/// switched on gradually; otherwise compressional waves travel up and down and oscillate in the
/// stress, which steps of about 10 us do not resolve.
static Case skin_case() {
    Case c = test::small_tissue();
    Layer skin = c.scene.medium.layers[0];
    skin.thickness_m = 1.2e-3;
    skin.c_s_m_s = 9.0;
    skin.loss = KelvinVoigt{1.0};
    c.scene.medium.layers.insert(c.scene.medium.layers.begin(), skin);
    test::travel_of(c).path = {{-9e-3, 0.0}, {200e-3, 0.0}};
    c.scene.load.modulation.envelope = {{RampGain{.duration_s = 2e-3}}};
    c.domain = {36, 24, 1e-3, 0.0};
    c.afferents = AfferentOptions{};
    c.afferents->input = StressInput{};
    return c;
}

/// The maximum over the depths of the relative L2 differences of the last frame.
static double difference(const Case& c, const test::StressStore& a, const test::StressStore& b) {
    double worst = 0.0;
    for (std::size_t depth = 0; depth < receptors; ++depth)
        worst = std::max(
            worst, relative_l2(a.at(c.time.frames - 1, depth), b.at(c.time.frames - 1, depth)));
    return worst;
}

static test::StressStore exact(Case c) {
    c.solver = LayeredOptions{.time_step_s = 12.5e-6};
    return test::stresses_of(c);
}

TEST_CASE("receptor stress equals that of the exact engine", "[verify][neural]") {
    Case c = skin_case(), layers = c;
    SECTION("in layers") {}
    SECTION("in a half-space") {
        c.scene.medium.base = layers.scene.medium.base = Base::half_space;
    }
    SECTION("in a body that fills a layer") {
        c.scene.medium.layers[0].c_s_m_s = 5.0;
        c.scene.medium.bodies = {{.name = "slab",
                                  .shape = Box{{1.0, 1.0, 1.2e-3}},
                                  .centre_m = {0.0, 0.0, 0.6e-3},
                                  .c_s_m_s = 9.0}};
    }
    const double found = difference(c, test::stresses_of(with_step(c, 12.5e-6)), exact(layers));
    CHECK(found < 2e-3);
}

TEST_CASE("receptor stress just above a rigid layer equals that above a rigid base",
          "[verify][neural][extended]") {
    Case c = skin_case(), base = c;
    c.scene.medium.bodies = {{.name = "slab", // 0.2 mm below the deepest receptors
                              .shape = Box{{1.0, 1.0, 3e-3}},
                              .centre_m = {0.0, 0.0, 3.7e-3},
                              .rigid = true}};
    base.scene.medium.layers[1].thickness_m = 1e-3;
    CHECK(difference(c, test::stresses_of(with_step(c, 12.5e-6)), exact(base)) < 2e-3);
}

TEST_CASE("receptor stress converges with second order in the step", "[verify][neural]") {
    const Case c = skin_case();
    const test::StressStore reference = exact(c);
    double step_s = 100e-6, order = 9.0;
    double error = difference(c, test::stresses_of(with_step(c, step_s)), reference);
    for (int n = 0; n < 2; ++n) {
        step_s /= 2.0;
        const double halved = difference(c, test::stresses_of(with_step(c, step_s)), reference);
        CAPTURE(step_s, error, halved);
        order = std::min(order, std::log2(error / halved));
        error = halved;
    }
    test::check_order("spectral, time step, stress at receptors", 2.0, order, 0.2);
}

TEST_CASE("receptor stress equals the stress volumes at the same depth", "[verify][neural]") {
    Case c = test::small_tissue();
    c.afferents = AfferentOptions{};
    c.afferents->input = StressInput{};
    c.scene.medium.layers.assign(4,
                                 c.scene.medium.layers[0]); // element boundaries at the receptors
    const double thickness_m[] = {0.3e-3, 1.3e-3, 0.4e-3, 5e-3};
    for (std::size_t i = 0; i < 4; ++i)
        c.scene.medium.layers[i].thickness_m = thickness_m[i];
    SECTION("layers") {}
    SECTION("an elastic body") {
        c.scene.medium.bodies = {test::small_body(GENERATE(0.25, 4.0))};
        c.scene.medium.bodies[0].centre_m.z = 1.9e-3;
        c.scene.medium.bodies[0].viscosity_Pa_s = 2.0; // four times that of the tissue
    }
    SECTION("just above a rigid body") {
        c.scene.medium.bodies = {test::small_body()};
        c.scene.medium.bodies[0].centre_m.z = 3.6e-3; // its top is at 2.1 mm
        c.scene.medium.bodies[0].rigid = true;
    }
    SECTION("just above a rigid cylinder across the domain") {
        c.scene.medium.bodies = {
            {.name = "cylinder",
             .shape = Cylinder{.radius_m = 1.5e-3, .azimuth_deg = GENERATE(0.0, 90.0)},
             .centre_m = {1e-3, -1e-3, 3.6e-3},
             .density_kg_m3 = 1900.0,
             .rigid = true}};
    }
    c.time.frames = 10;
    c.record.volumes_s = {c.time.frame_s(9)};
    c.record.volume_fields = {VolumeField::stress};
    c = with_step(c, 50e-6);
    const auto volumes = test::frames_of<test::VolumeStore>(c);
    const test::StressStore found = test::stresses_of(c);
    constexpr std::size_t zz = 2;
    for (std::size_t depth = 0; depth < receptors; ++depth) {
        const double depth_m = stress_depths_m(c)[depth];
        const auto& z_m = volumes.z_m();
        const auto level = static_cast<std::size_t>(
            std::find_if(z_m.begin(), z_m.end(),
                         [&](double z) { return std::abs(z - depth_m) < 1e-9; }) -
            z_m.begin());
        REQUIRE(level < z_m.size());
        std::vector<double> compression = volumes.at(0, 0, zz, level);
        for (double& value : compression)
            value = -value;
        CAPTURE(depth);
        CHECK(test::largest(compression) > 0.2); // relative to 1 Pa
        // The same sums in a different order; lambda/mu = 1e5 amplifies their rounding.
        CHECK(relative_l2(found.at(9, depth), compression) < 1e-8);
    }
}

TEST_CASE("static mean stress equals the mean load at any depth including around a body",
          "[verify][neural]") {
    // Averaged over the plane, d sigma_zz / dz = rho d2 u_z / dt2 for any stiffness, which is zero
    // at rest.
    Case c = test::small_tissue(5.0);
    c.scene.medium.bodies = {test::small_body(16.0)};
    c.scene.medium.bodies[0].centre_m.z = 2e-3;
    c.scene.load.modulation = {
        .kind = "AM", .trajectory = {{Hold{}}}, .envelope = {{RampGain{.duration_s = 5e-3}}}};
    c.time = {40, 400e-6};
    c.measure = {.at_s = 16e-3, .settled_after_s = 5e-3, .focal_radius_m = 3e-3};
    c.afferents = AfferentOptions{};
    c.afferents->input = StressInput{};
    c.solver = SpectralOptions{.longest_element_m = 0.5e-3};
    const test::StressStore found = test::stresses_of(with_step(c, 200e-6));
    const double area_m2 = c.domain.extent_x_m() * c.domain.extent_y_m();
    const double load_Pa = M_PI * 9e-6 / (4.0 * std::log(2.0)) / area_m2; // a Gaussian of 1 Pa
    for (std::size_t depth = 0; depth < receptors; ++depth) {
        CAPTURE(depth);
        // Only rounding errors above the body. Where its curved face cuts elements of 0.5 mm, 0.9 %
        // are observed, and 7 % without the part of the stress across the surface.
        CHECK(test::mean(found.at(c.time.frames - 1, depth)) ==
              Approx(load_Pa).epsilon(depth == 0 ? 1e-6 : 0.01));
    }
}

} // namespace test_receptor_stress
