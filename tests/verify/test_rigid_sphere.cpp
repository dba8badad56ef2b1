// SPDX-License-Identifier: BSD-3-Clause
// The forces that move a rigid sphere in engine "spectral" compared with closed forms, static and
// at real exponential growth e^{st}.
#include "support/rigid_sphere.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_rigid_sphere {

using namespace shearwake;
using test::RigidSphere;

/// A translation along an axis, by one radius.
static auto along(std::size_t axis) {
    return [axis](Vec3) { return spectral::motions_at({})[axis]; };
}

/// Relative errors of the mean force, of the force along an axis, and of the torques about a
/// horizontal axis and about the vertical.
struct Errors {
    double mean, along_x, about_x, about_z;
};
static Errors errors(double spacings_per_radius, double kappa, double width) {
    const RigidSphere sphere(spacings_per_radius, kappa, width);
    double force[3], torque[3];
    for (std::size_t i = 0; i < 3; ++i) {
        force[i] = sphere.stiffness(along(i));
        torque[i] = sphere.stiffness(
            [&](Vec3 r) { return (1.0 / test::body_radius_m) * spectral::motions_at(r)[3 + i]; });
    }
    // Images of the sphere at the surface, the base and the periodic edges increase the force along
    // z and decrease the ones along x and y by half as much.
    const double of_force = test::force_on_sphere(kappa), of_torque = test::torque_on_sphere(kappa);
    return {(force[0] + force[1] + force[2]) / 3.0 / of_force - 1.0, force[0] / of_force - 1.0,
            torque[0] / of_torque - 1.0, torque[2] / of_torque - 1.0};
}

/// The static force on a sphere per displacement, radius and mu in a solid without edges.
///
/// A sphere displaced by U carries a force F and adds S F to its own displacement through its
/// images at the surface, the base and the periodic edges, so that U = F/k + S F with the
/// stiffness k in an infinite solid. The images are as far away as the domain is wide, and their
/// field varies over the sphere: S = c/w + d/w^3 for all domains of this shape. Three widths
/// determine 1/k.
static double static_force(double spacings_per_radius, double lambda_per_mu) {
    const double widths[3] = {6.0, 8.0, 12.0};
    double per_force[3];
    for (std::size_t n = 0; n < 3; ++n) {
        const RigidSphere sphere(spacings_per_radius, 0.0, widths[n], lambda_per_mu);
        per_force[n] = 0.0;
        for (std::size_t axis = 0; axis < 3; ++axis)
            per_force[n] += 1.0 / (3.0 * sphere.stiffness(along(axis)));
    }
    // Divided differences of w/F = w/k + c + d/w^2 at pairs of widths.
    const auto difference = [&](const auto& f, std::size_t a, std::size_t b) {
        return (f(b) - f(a)) / (widths[b] - widths[a]);
    };
    const auto value = [&](std::size_t n) { return widths[n] * per_force[n]; };
    const auto square = [&](std::size_t n) { return std::pow(widths[n], -2); };
    const double first = difference(value, 0, 1), second = difference(value, 1, 2);
    const double of_first = difference(square, 0, 1), of_second = difference(square, 1, 2);
    return (of_second - of_first) / (first * of_second - second * of_first);
}

TEST_CASE("force on an oscillating rigid sphere agrees with the closed form", "[verify]") {
    const double kappa = GENERATE(0.5, 1.0, 2.0); // at 3 mm and 5 m/s: 130, 270 and 530 Hz
    const Errors at_6 = errors(6.0, kappa, 10.0);
    CAPTURE(kappa, at_6.mean, at_6.along_x, at_6.about_x, at_6.about_z);
    CHECK(std::abs(at_6.mean) < 0.02); // required
    CHECK(std::abs(at_6.about_x) < 0.03);
    CHECK(std::abs(at_6.about_z) < 0.03);
}

TEST_CASE("static force on a rigid sphere agrees with the closed form", "[verify]") {
    // Displaced by U in an infinite elastic solid, a bonded rigid sphere experiences the force
    // 24 pi (1 - nu)/(5 - 6 nu) mu a U (Lurie, Three-Dimensional Problems of the Theory of
    // Elasticity, 1964), which is Stokes' 6 pi mu a U for nu = 1/2.
    const double nu = GENERATE(0.5, 0.3);
    const double exact = 24.0 * std::numbers::pi * (1.0 - nu) / (5.0 - 6.0 * nu);
    const double force =
        static_force(6.0, nu < 0.5 ? 2.0 * nu / (1.0 - 2.0 * nu) : test::incompressible);
    CAPTURE(nu, force, exact, force / exact - 1.0);
    CHECK(std::abs(force / exact - 1.0) < 0.02); // required
}

TEST_CASE("force on a rigid sphere converges as the grid is refined", "[verify]") {
    const Errors at_4 = errors(4.0, 2.0, 10.0), at_8 = errors(8.0, 2.0, 10.0);
    CAPTURE(at_4.mean, at_4.about_x, at_8.mean, at_8.about_x);
    CHECK(std::abs(at_8.mean) < 0.5 * std::abs(at_4.mean)); // first order would leave a half
    CHECK(std::abs(at_8.about_x) < 0.5 * std::abs(at_4.about_x));
}

TEST_CASE("force of a shear wave on a rigid sphere agrees with the closed form",
          "[verify][extended]") {
    // The force is the amplitude of the scattered wave far from the sphere.
    const double kappa = GENERATE(1.0, 2.0);
    const RigidSphere sphere(6.0, kappa, 10.0);
    const auto force = [&](const auto& wave, std::size_t component) {
        const std::vector<double> all = sphere.forces(sphere.at_markers(wave));
        double sum = 0.0;
        for (std::size_t i = component; i < all.size(); i += 3)
            sum += all[i];
        return sum / (test::solid_mu_Pa * test::body_radius_m);
    };
    const double level = force(
        [&](Vec3 r) {
            return Vec3{0.0, std::exp(kappa * r.x / test::body_radius_m), 0.0};
        },
        1);
    const double upright = force(
        [&](Vec3 r) {
            return Vec3{0.0, 0.0, std::exp(kappa * r.x / test::body_radius_m)};
        },
        2);
    const double upwards = force(
        [&](Vec3 r) {
            return Vec3{std::exp(-kappa * r.z / test::body_radius_m), 0.0, 0.0};
        },
        0);
    // As for the force of a motion, the images act on the mean of the directions least.
    const double mean = (level + upright + upwards) / 3.0, exact = test::force_in_wave(kappa);
    CAPTURE(kappa, level, upright, upwards, mean, exact);
    CHECK(mean == Approx(exact).epsilon(0.03)); // required
}

} // namespace test_rigid_sphere
