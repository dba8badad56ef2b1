// SPDX-License-Identifier: BSD-3-Clause
// The forces that move a rigid sphere in engine "spectral" compared with closed forms, static and
// at real exponential growth e^{st}.
#include "support/rigid_sphere.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace shearwake;
using test::RigidSphere;

namespace {

/// A translation along an axis, by one radius.
auto along(std::size_t axis) {
    return [axis](Vec3) { return spectral::motions_at({})[axis]; };
}

/// Relative errors of the mean force, of the force along an axis, and of the torques about a
/// horizontal axis and about the vertical.
struct Errors {
    double mean, along_x, about_x, about_z;
};
Errors errors(double spacings_per_radius, double kappa, double width) {
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
double static_force(double spacings_per_radius, double lambda_per_mu) {
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

/// The stress sigma_zz around a sphere of radius 1 in an incompressible solid of mu = 1 that is
/// displaced by U at growth e^{st}, x = s a/c_s (Stokes, 1851): the displacement is
///     grad(C U.r/r^3) + curl curl (B U h),   h = e^{-x r}/r,   with the pressure -x^2 C U.r/r^3.
class StressAroundSphere {
public:
    StressAroundSphere(double x, Vec3 shift)
        : x_(x), shift_(shift), b_(-1.5 * std::exp(x) / (x * x)),
          c_(-0.5 + b_ * (1.0 + x) * std::exp(-x)) {}

    double zz(Vec3 r) const {
        constexpr double step = 1e-4; // fourth-order differences; errors of 1e-12
        const auto u = [&](double by) { return displacement(r + Vec3{0.0, 0.0, by * step}).z; };
        const double slope = (8.0 * (u(1.0) - u(-1.0)) - (u(2.0) - u(-2.0))) / (12.0 * step);
        return x_ * x_ * c_ * dot(shift_, r) / std::pow(norm(r), 3) + 2.0 * slope;
    }
    Vec3 displacement(Vec3 r) const {
        const double distance = norm(r), h = std::exp(-x_ * distance) / distance;
        const double slope = -(x_ + 1.0 / distance) * h / distance; // h'/r
        const double along = dot(shift_, r) / (distance * distance), cube = std::pow(distance, 3);
        return (c_ / cube + b_ * (slope - x_ * x_ * h)) * shift_ +
               (along * (b_ * (x_ * x_ * h - 3.0 * slope) - 3.0 * c_ / cube)) * r;
    }

private:
    static double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    double x_;
    Vec3 shift_;
    double b_, c_;
};

} // namespace

TEST_CASE("stress above an oscillating rigid sphere agrees with the closed form",
          "[verify][neural]") {
    constexpr double kappa = 2.0; // at 3 mm and 5 m/s: 530 Hz
    const Vec3 down{0.0, 0.0, 1.0}, right{1.0, 0.0, 0.0};
    REQUIRE(norm(StressAroundSphere(kappa, right).displacement({0.6, 0.0, -0.8}) - right) < 1e-12);
    RigidSphere sphere(6.0, kappa, 10.0);
    const double unit_Pa = test::solid_mu_Pa / test::body_radius_m;
    for (const Vec3& shift : {down, right}) {
        const StressAroundSphere exact(kappa, shift);
        const std::vector<double> forces =
            sphere.forces(sphere.at_markers([&](Vec3) { return shift; }));
        for (const double height : {1.17, 1.33, 1.5}) { // 1, 2 and 3 spacings above the sphere
            std::vector<Vec3> points;
            for (const double x : {-0.6, 0.0, 0.3, 0.9})
                for (const double y : {-0.4, 0.1})
                    points.push_back({test::body_radius_m * x, test::body_radius_m * y,
                                      -test::body_radius_m * height});
            const std::vector<double> found = sphere.vertical_stress(forces, points);
            double error = 0.0, size = 0.0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                const double expected = exact.zz((1.0 / test::body_radius_m) * points[i]);
                error += std::pow(found[i] / unit_Pa - expected, 2);
                size += expected * expected;
                UNSCOPED_INFO(found[i] / unit_Pa << " " << expected);
            }
            CAPTURE(shift.z, height, std::sqrt(error / size));
            CHECK(std::sqrt(error / size) < 0.03);
        }
    }
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

TEST_CASE("force of a shear wave on a rigid sphere agrees with the closed form", "[verify]") {
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
