// SPDX-License-Identifier: BSD-3-Clause
// Engine "spectral" with bodies and maps that are less viscous than the layer around them.
#include "support/spectral_cases.hpp"

#include <catch2/catch.hpp>

namespace test_spectral_viscosity {

using namespace shearwake;

/// A focus of 4 mm at rest over 10 mm of tissue, modulated at a frequency, without or with a sphere
/// of 4 mm radius.
static Case pressed(double frequency_Hz, double depth = 1.0) {
    Case c = test::focus_over_rigid_base(0.5, {10e-3}, 0.0);
    c.scene.load.footprint = GaussianFootprint{4e-3};
    c.scene.load.modulation.trajectory = {{Hold{{0.0, 0.0}}}};
    c.scene.load.modulation.envelope = {{SineGain{frequency_Hz, depth}}};
    c.domain = {32, 30, 1e-3, 0.0};
    c.time = {60, 100e-6};
    c.measure = {.at_s = 6e-3, .settled_after_s = 1e-3, .focal_radius_m = 3e-3};
    c.solver = SpectralOptions{.time_step_s = 50e-6};
    return c;
}

static Case with_sphere(Case c, double viscosity_Pa_s) {
    c.scene.medium.bodies = {{.name = "sphere",
                              .shape = Ellipsoid{{4e-3, 4e-3, 4e-3}},
                              .centre_m = {0.0, 0.0, 4.5e-3},
                              .viscosity_Pa_s = viscosity_Pa_s}};
    return c;
}

TEST_CASE("the effect of a sphere follows its viscosity, however small the difference",
          "[verify]") {
    const Case uniform = pressed(150.0);
    const auto without = test::last_frame(with_sphere(uniform, 0.5)); // elements end at the sphere
    const auto effect_per_Pa_s = [&](double viscosity_Pa_s) {
        return test::relative_l2(test::last_frame(with_sphere(uniform, viscosity_Pa_s)), without) /
               (0.5 - viscosity_Pa_s);
    };
    const double slight = effect_per_Pa_s(0.475), tenth = effect_per_Pa_s(0.45),
                 quarter = effect_per_Pa_s(0.375), half = effect_per_Pa_s(0.25);
    CAPTURE(slight, tenth, quarter, half);
    // To first order the effect is proportional to the difference in viscosity. Half of the
    // viscosity adds higher orders, of the size of the change of the strain in the sphere.
    CHECK(slight > 0.03); // observed 0.052 per Pa s
    CHECK(tenth == Approx(slight).epsilon(0.03));
    CHECK(quarter == Approx(slight).epsilon(0.05));
    CHECK(half == Approx(slight).epsilon(0.1));
}

TEST_CASE("a modulation of depth 0 is a constant force at any frequency", "[verify]") {
    const auto slow = test::last_frame(with_sphere(pressed(1.0, 0.0), 0.25));
    const auto fast = test::last_frame(with_sphere(pressed(20.0, 0.0), 0.25));
    CHECK(slow == fast);
}

TEST_CASE("a map of a lower viscosity is equivalent to a layer", "[verify]") {
    Case c = pressed(150.0), layers = c;
    c = test::with_step(c, 25e-6);
    const auto map = test::sheet_map();
    map->viscosity_Pa_s.assign(16, 0.3);
    map->content_hash = hash_of(*map);
    test::divide_layer(layers, {3e-3, 3.2e-3, 3.8e-3});
    layers.scene.medium.layers[1].loss = KelvinVoigt{0.3};
    layers.solver = LayeredOptions{.time_step_s = 25e-6};
    const auto without = test::last_frame(c), exact = test::last_frame(layers);
    c.scene.medium.map = map;
    const double difference = test::relative_l2(test::last_frame(c), exact);
    const double effect = test::relative_l2(without, exact);
    CAPTURE(difference, effect);
    CHECK(difference < 1e-3); // error of the time step
    CHECK(effect > 10.0 * difference);
}

} // namespace test_spectral_viscosity
