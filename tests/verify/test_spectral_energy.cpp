// SPDX-License-Identifier: BSD-3-Clause
// The discrete energy of engine "spectral" is conserved without load and losses, and never exceeds
// the work of the load.
#include "support/rigid_cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace test_spectral_energy {

using namespace shearwake;
using test::ellipsoid;
using test::step_through;

/// Lossless, 9 mm in three layers, a 3 mm focus at 7 m/s that is switched off after 2 of 12 ms.
static Case lossless_case() {
    Case c = test::focus_over_rigid_base(0.0, {3e-3, 3e-3, 3e-3}, -7e-3, 7e-3);
    c.scene.medium.layers[1].c_s_m_s = 8.0;
    c.scene.medium.layers[1].density_kg_m3 = 1100.0;
    c.domain = {32, 24, 1.25e-3, 0.0};
    c.time = {120, 100e-6};
    return c;
}

TEST_CASE("energy of a lossless medium is conserved after the load has ended", "[long][verify]") {
    Case c = lossless_case();
    SpectralOptions options{.time_step_s = 50e-6};
    SECTION("layers") {}
    SECTION("a body, one solve per step") {
        options.method = SpectralMethod::one_solve;
        c.scene.medium.bodies = {ellipsoid(4.0)};
    }
    SECTION("a stiff and dense body, iterations") {
        options.residual = 1e-12; // its error accumulates over 200 steps
        c.scene.medium.bodies = {ellipsoid(16.0)};
        c.scene.medium.bodies[0].density_kg_m3 = 1300.0;
    }
    c.solver = options;
    double after = 0.0, worst = 0.0, work = 0.0;
    step_through(c, [&](spectral::Stepper& stepper) {
        if (stepper.step() < 42) return; // the correction of the load extends one step beyond 2 ms
        const spectral::EnergyBalance balance = stepper.energy();
        if (stepper.step() == 42) after = balance.energy_J, work = balance.work_J;
        worst = std::max(worst, std::abs(balance.energy_J / after - 1.0));
    });
    CAPTURE(after, work, worst);
    CHECK(after > 0.0);
    CHECK(worst < 1e-8);                        // required
    CHECK(after == Approx(work).epsilon(1e-8)); // equals the work of the load
}

TEST_CASE("viscosity reduces the energy at every step", "[verify]") {
    Case c = lossless_case();
    c.domain = {24, 20, 1.25e-3, 0.0};
    c.time.frames = 70;
    c.scene.medium.layers[0].loss = KelvinVoigt{0.5};
    c.scene.medium.bodies = {ellipsoid(4.0)};
    c.scene.medium.bodies[0].viscosity_Pa_s = 2.0;
    c.solver = SpectralOptions{.time_step_s = 50e-6, .residual = 1e-10};
    double last = 0.0, first = 0.0, most_gain = 0.0;
    step_through(c, [&](spectral::Stepper& stepper) {
        const spectral::EnergyBalance balance = stepper.energy();
        CHECK(balance.energy_J <= balance.work_J * (1.0 + 1e-8)); // up to the residual
        if (stepper.step() == 42) first = balance.energy_J;
        if (stepper.step() > 42) most_gain = std::max(most_gain, balance.energy_J / last - 1.0);
        last = balance.energy_J;
    });
    CAPTURE(first, last);
    CHECK(most_gain < 1e-9); // never increases, up to the residual
    CHECK(last < 0.5 * first);
}

TEST_CASE("a lossless medium is stable at any step", "[verify]") {
    // From steps that need no stabilisation to steps that are long compared with the periods of the
    // grid's waves.
    const double step_s = GENERATE(25e-6, 40e-6, 50e-6, 80e-6, 100e-6, 200e-6);
    const double c_s_m_s = GENERATE(5.0, 10.0);
    Case c = lossless_case();
    c.scene.medium.layers = {c.scene.medium.layers[0]};
    c.scene.medium.layers[0].thickness_m = 12e-3;
    c.scene.medium.layers[0].c_s_m_s = c_s_m_s;
    c.scene.load.footprint = GaussianFootprint{2e-3};
    c.domain = {48, 36, 2e-3 / 3.0, 0.0};
    c.time = {20, 200e-6};
    c.solver = SpectralOptions{.time_step_s = step_s};
    CAPTURE(step_s, c_s_m_s);
    double largest = 0.0; // kinetic and elastic energy relative to the work
    CHECK_NOTHROW(step_through(c, [&](spectral::Stepper& stepper) {
        const spectral::EnergyBalance balance = stepper.energy(); // throws if the field diverges
        largest = std::max(largest, balance.energy_J / balance.work_J);
    }));
    CHECK(largest == Approx(1.0).epsilon(1e-8)); // no other source or sink of energy
}

/// A layer of 8 mm in two elements.
static Case compressible_case(double c_p_m_s, double step_s) {
    Case c = lossless_case();
    Layer& layer = c.scene.medium.layers[0];
    layer.thickness_m = 8e-3;
    layer.c_s_m_s = 10.0;
    layer.c_p_m_s = c_p_m_s;
    c.scene.medium.layers = {layer};
    c.domain = {16, 12, 2e-3, 0.0};
    c.time = {30, 200e-6};
    c.solver = SpectralOptions{.time_step_s = step_s, .longest_element_m = 4e-3, .residual = 1e-10};
    return c;
}

static std::vector<double> compressible_steps_s() {
    return test::parameters(3, std::vector{12.5e-6, 40e-6, 100e-6, 20e-6, 25e-6, 50e-6});
}

TEST_CASE("a medium of any compressibility is stable at any step", "[verify]") {
    // The shear stiffness resists compression as well, and lambda does not make up for this where
    // c_p is below about 6 c_s. Below c_p = sqrt(2) c_s lambda is negative.
    const double c_p_m_s = GENERATE(12.0, 14.5, 20.0, 30.0, 60.0, 200.0);
    const double step_s = GENERATE(from_range(compressible_steps_s()));
    CAPTURE(c_p_m_s, step_s);
    double largest = 0.0; // energy relative to the work
    CHECK_NOTHROW(step_through(compressible_case(c_p_m_s, step_s), [&](spectral::Stepper& stepper) {
        const spectral::EnergyBalance balance = stepper.energy(); // throws if the field diverges
        largest = std::max(largest, balance.energy_J / balance.work_J);
    }));
    CHECK(largest == Approx(1.0).epsilon(1e-8)); // no other source of energy
}

struct Compressible {
    double layer_c_p_m_s, layer_c_s_m_s, body_c_p_m_s, body_c_s_m_s;
};

TEST_CASE("a body of any compressibility is stable at any step", "[verify][extended]") {
    // Below c_p = sqrt(2) c_s lambda is negative; the bulk modulus is positive above 1.155 c_s.
    // Then the least lambda and the least mu of a plane together are no solid.
    const auto m = GENERATE(Compressible{20.0, 5.0, 12.0, 10.0}, // four times stiffer
                            Compressible{20.0, 5.0, 24.0, 20.0}, // 16 times stiffer
                            Compressible{6.0, 5.0, 58.5, 50.0},  // 100 times stiffer
                            Compressible{60.0, 5.0, 23.5, 20.0}, // lambda of the layer 142 mu
                            Compressible{12.0, 10.0, 20.0, 5.0}, // softer
                            Compressible{12.0, 10.0, 4.9, 4.0}); // also with negative lambda
    const double step_s = GENERATE(from_range(compressible_steps_s()));
    CAPTURE(m.layer_c_p_m_s, m.layer_c_s_m_s, m.body_c_p_m_s, m.body_c_s_m_s, step_s);
    Case c = compressible_case(m.layer_c_p_m_s, step_s);
    c.scene.medium.layers[0].c_s_m_s = m.layer_c_s_m_s;
    c.scene.medium.bodies = {ellipsoid(1.0)};
    c.scene.medium.bodies[0].c_p_m_s = m.body_c_p_m_s;
    c.scene.medium.bodies[0].c_s_m_s = m.body_c_s_m_s;
    c.domain = {12, 8, 2e-3, 0.0};
    c.time.frames = 12;               // the load ends after 10
    double largest = 0.0, last = 0.0; // energy relative to the work
    CHECK_NOTHROW(step_through(c, [&](spectral::Stepper& stepper) {
        if (stepper.step() % 4 != 0) return;
        const spectral::EnergyBalance balance = stepper.energy(); // throws if the field diverges
        last = balance.energy_J / balance.work_J;
        largest = std::max(largest, last);
    }));
    CHECK(largest < 1.0 + 1e-6); // no other source of energy, up to the residual
    CHECK(last > 1.0 - 1e-6);
}

TEST_CASE("energy of a compressible layer with a stiff viscous body never increases",
          "[verify][extended]") {
    const double step_s = 25e-6, viscosity_Pa_s = GENERATE(0.0, 1.0, 4.0);
    Case c = compressible_case(20.0, step_s);
    c.scene.medium.layers[0].c_s_m_s = 5.0;
    c.scene.medium.layers[0].loss = KelvinVoigt{1.0};
    c.scene.medium.bodies = {ellipsoid(4.0)};
    c.scene.medium.bodies[0].viscosity_Pa_s = viscosity_Pa_s;
    c.time.frames = 15;
    double last = 0.0, most_gain = 0.0;
    CHECK_NOTHROW(step_through(c, [&](spectral::Stepper& stepper) {
        if (stepper.step() < 81) return; // the correction of the load extends one step beyond 2 ms
        const spectral::EnergyBalance balance = stepper.energy();
        CHECK(balance.energy_J <= balance.work_J);
        if (last > 0.0) most_gain = std::max(most_gain, balance.energy_J / last - 1.0);
        last = balance.energy_J;
    }));
    CAPTURE(viscosity_Pa_s, last);
    CHECK(last > 0.0);
    CHECK(most_gain < 1e-9); // up to the residual
}

} // namespace test_spectral_energy
