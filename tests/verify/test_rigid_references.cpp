// SPDX-License-Identifier: BSD-3-Clause
// Rigid cylinders in engine "spectral" compared with closed forms: the forces that move one, and
// the scattering of a shear wave. Both are evaluated at real exponential growth e^{st} instead of
// e^{i omega t}, where the engine's implicit operator is that of a viscoelastic medium.
#include "support/rigid_cylinder.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_rigid_references {

using namespace shearwake;

using test::bessel_i;
using test::bessel_k;
using test::body_radius_m;
using test::RigidCylinder;
using test::solid_mu_Pa;
constexpr double pi = std::numbers::pi;

/// Forces per length, displacement and mu that move a rigid cylinder full of background. Outside:
/// Stokes' second problem (K_0 and K_1); inside: its mass.
static double along_axis(double x) {
    return 2.0 * pi * x * bessel_k(1, x) / bessel_k(0, x) + pi * x * x;
}
static double across_axis(double x) {
    return pi * x * x * (2.0 + 4.0 * bessel_k(1, x) / (x * bessel_k(0, x)));
}
static double about_axis(double x) { // torque over radius^2
    return 2.0 * pi * (2.0 + x * bessel_k(0, x) / bessel_k(1, x)) + 0.5 * pi * x * x;
}

/// Relative errors of the force along the axis, across it, and of the torque.
static Vec3 errors(double spacings_per_radius, double kappa) {
    const RigidCylinder cylinder(spacings_per_radius, kappa);
    const double axial = cylinder.stiffness([](double, double) { return Vec3{1.0, 0.0, 0.0}; });
    const double level = cylinder.stiffness([](double, double) { return Vec3{0.0, 1.0, 0.0}; });
    const double upright = cylinder.stiffness([](double, double) { return Vec3{0.0, 0.0, 1.0}; });
    const double torque = cylinder.stiffness([](double across, double down) {
        return Vec3{0.0, down / body_radius_m, -across / body_radius_m};
    });
    // The images of the cylinder at the surface, the base and the periodic edges increase one of
    // level and upright and decrease the other by the same amount.
    return {axial / along_axis(kappa) - 1.0, 0.5 * (level + upright) / across_axis(kappa) - 1.0,
            torque / about_axis(kappa) - 1.0};
}

TEST_CASE("force on an oscillating rigid cylinder agrees with the closed form", "[verify]") {
    const double kappa = GENERATE(0.5, 1.0, 2.0); // at 3 mm and 5 m/s: 130, 270 and 530 Hz
    const Vec3 at_6 = errors(6.0, kappa);
    CAPTURE(kappa, at_6.x, at_6.y, at_6.z);
    // Required for spheres at 6 spacings per radius.
    CHECK(std::abs(at_6.x) < 0.02);
    CHECK(std::abs(at_6.y) < 0.02);
    CHECK(std::abs(at_6.z) < 0.02);
}

TEST_CASE("force on a rigid cylinder converges as the grid is refined", "[verify]") {
    const Vec3 at_4 = errors(4.0, 1.0), at_12 = errors(12.0, 1.0);
    CAPTURE(at_4.x, at_4.y, at_4.z, at_12.x, at_12.y, at_12.z);
    // Observed 0.44: first order leaves a third of the torque's error, and the images of the
    // cylinder a part that does not depend on the grid. They are all of the other errors, at most
    // .0045.
    CHECK(std::abs(at_12.z) < 0.5 * std::abs(at_4.z));
    CHECK(std::abs(at_12.x) < 0.01);
    CHECK(std::abs(at_12.y) < 0.01);
}

TEST_CASE("a rigid cylinder scatters a shear wave as the closed form", "[verify]") {
    // The wave e^{kappa x/a}, polarised along the axis, is the sum of e_n I_n(kappa r/a) cos(n
    // theta) with e_n = 2 - [n = 0]. It is scattered to -e_n I_n(kappa)/K_n(kappa) K_n(kappa r/a)
    // cos(n theta). Of that, the amplitude in the direction phi is
    //     sum of F e^{kappa (x cos phi + z sin phi)/a}/(2 pi mu)
    // over the forces F, and the sum of -e_n I_n/K_n cos(n phi).
    const double kappa = GENERATE(0.5, 1.0);
    const bool is_level = GENERATE(true, false); // the wave travels across the axis or upwards
    const double per_radius = 12.0;
    const RigidCylinder cylinder(per_radius, kappa);
    const auto wave = [&](double across_m, double down_m, double phi) {
        // At a marker it is smoothed across the axis.
        const double smoothing = spectral::marker_smoothing * std::cos(phi) / per_radius;
        return std::exp(kappa * (across_m * std::cos(phi) + down_m * std::sin(phi)) /
                            body_radius_m +
                        0.5 * std::pow(kappa * smoothing, 2));
    };
    const double incident = is_level ? 0.0 : -0.5 * pi;
    const Eigen::VectorXd forces = cylinder.forces([&](double across_m, double down_m) {
        return Vec3{-wave(across_m, down_m, incident), 0.0, 0.0};
    });
    for (const double phi : {0.0, 0.5 * pi, pi}) {
        double scattered = 0.0, exact = 0.0;
        for (std::size_t i = 0; i < cylinder.markers().size(); ++i)
            scattered +=
                forces[static_cast<Eigen::Index>(3 * i)] *
                wave(cylinder.markers()[i].across_m, cylinder.markers()[i].down_m, incident + phi) /
                (2.0 * pi * solid_mu_Pa);
        for (int n = 0; n < 12; ++n)
            exact -=
                (n > 0 ? 2.0 : 1.0) * bessel_i(n, kappa) / bessel_k(n, kappa) * std::cos(n * phi);
        CAPTURE(kappa, is_level, phi, scattered, exact, scattered / exact - 1.0);
        CHECK(scattered == Approx(exact).epsilon(0.03)); // required for spheres
    }
}

TEST_CASE("a rigid body is the limit of a stiff elastic one", "[long][verify]") {
    // A bar of 5.4 x 5.4 mm and a load on a line, as plane strain. The faces of the bar coincide
    // with those of grid cells at both spacings, 0.9 and 0.3 mm. Between the cells an elastic body
    // is stiff up to a part of a spacing beyond its face. This error is of first order, and three
    // halves of the finer minus half of the coarser result do not contain it.
    const auto effect = [](std::ptrdiff_t times, const Body& bar) {
        Case c = test::focus_over_rigid_base(0.5, {9e-3}, -5e-3, 7e-3);
        c.domain = {24 * times, 4, 0.9e-3 / static_cast<double>(times), 0.0};
        c.time = {6, 100e-6};
        c.measure = {.at_s = 6e-4, .settled_after_s = 1e-4, .focal_radius_m = 1e-3};
        c.solver = SpectralOptions{.time_step_s = 10e-6,
                                   .longest_element_m = 1.8e-3,
                                   .contrast_cap = 1e5,
                                   .rigid_above = 1e9}; // the elastic bar remains elastic
        const auto without = test::last_frame(c);
        c.scene.medium.bodies = {bar};
        const auto with = test::last_frame(c);
        std::vector<double> change; // of the mean along y, whose width is four spacings
        for (std::ptrdiff_t i = 0; i < c.domain.nx; i += times)
            change.push_back(
                (with[static_cast<std::size_t>(4 * i)] - without[static_cast<std::size_t>(4 * i)]) /
                static_cast<double>(times));
        return change;
    };
    const Body rigid{.name = "bar",
                     .shape = Box{{5.4e-3, 1.0, 5.4e-3}},
                     .centre_m = {-4.05e-3, 0.0, 4.5e-3},
                     .density_kg_m3 = 1900.0,
                     .rigid = true};
    Body elastic = rigid;
    elastic.rigid = false;
    elastic.c_s_m_s = 1619.0;
    elastic.c_p_m_s = 3517.0;
    const auto coarse = effect(1, elastic), fine = effect(3, elastic);
    std::vector<double> limit;
    for (std::size_t i = 0; i < fine.size(); ++i)
        limit.push_back(1.5 * fine[i] - 0.5 * coarse[i]);
    const auto of_rigid = effect(3, rigid);
    const double difference = test::relative_l2(limit, of_rigid);
    CAPTURE(difference, test::relative_l2(fine, of_rigid), test::relative_l2(coarse, of_rigid));
    CHECK(difference > 0.001);                               // they are different computations
    CHECK(difference < 0.02);                                // observed 0.014
    CHECK(test::relative_l2(fine, of_rigid) < 0.03);         // required, without extrapolation
    CHECK(test::relative_l2(coarse, of_rigid) > difference); // the error of the elastic body
}

} // namespace test_rigid_references
