// SPDX-License-Identifier: BSD-3-Clause
// Elastic cylinders and spheres in plane shear waves: the cells of engine "spectral" compared with
// series of Bessel functions, at exponential growth.
#include "support/elastic_body.hpp"
#include "support/elastic_in_wave.hpp"

#include <catch2/catch.hpp>

namespace test_elastic_scattering {

using namespace shearwake;
using namespace shearwake::test;

constexpr double pi = std::numbers::pi;

/// Relative L2 difference between what is found and what is exact.
class Difference {
public:
    void add(double found, double exact) {
        above_ += (found - exact) * (found - exact);
        below_ += exact * exact;
    }
    double relative() const { return std::sqrt(above_ / below_); }

private:
    double above_ = 0.0, below_ = 0.0;
};

/// The axis of a cylinder and two directions across it.
struct Axes {
    Vec3 axis, first, second;

    Vec3 across(double angle) const { return std::cos(angle) * first + std::sin(angle) * second; }
    ElasticBody::Motion along_wave(double kappa, double angle) const {
        return [=, *this](Vec3 r) { return std::exp(kappa * dot(r, across(angle))) * axis; };
    }
    /// The curl of a wave along the axis.
    ElasticBody::Motion across_wave(double kappa, double angle) const {
        return [=, *this](Vec3 r) {
            return kappa * std::exp(kappa * dot(r, across(angle))) * across(angle + 0.5 * pi);
        };
    }
};

constexpr Axes along_x{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}},
    along_y{{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};

static Body with(Body body, Contrast contrast) {
    body.c_s_m_s = 5.0 * std::sqrt(contrast.modulus / contrast.density);
    if (contrast.density != 1.0) body.density_kg_m3 = solid_kg_m3 * contrast.density;
    return body;
}
static Body cylinder(double azimuth_deg) {
    return {.name = "cylinder",
            .shape = Cylinder{.radius_m = body_radius_m, .azimuth_deg = azimuth_deg}};
}
static Body sphere() {
    return {.name = "sphere", .shape = Ellipsoid{{body_radius_m, body_radius_m, body_radius_m}}};
}

struct Errors {
    double along = 0.0, across = 0.0; // polarisation of the wave
};

static Errors cylinder_errors(bool is_along_x, const Body& body, Contrast exact, double per_radius,
                              double kappa, Vec3 offset = {0.2, 0.3, 0.0}) {
    constexpr double width = 16.0;
    const Axes& axes = is_along_x ? along_x : along_y;
    ElasticBody cells(body, per_radius, kappa,
                      {is_along_x ? 0.0 : width, is_along_x ? width : 0.0, width}, offset);
    Difference along, across;
    for (const double angle : {0.0, 0.5 * pi, pi}) {
        constexpr double from = 0.3; // not aligned with the grid
        along.add(cells.work(axes.along_wave(kappa, from), axes.along_wave(kappa, from + angle)),
                  along_cylinder(kappa, exact, angle));
        across.add(cells.work(axes.across_wave(kappa, from), axes.across_wave(kappa, from + angle)),
                   across_cylinder(kappa, exact, angle));
    }
    return {along.relative(), across.relative()};
}
static Errors cylinder_errors(bool is_along_x, Contrast contrast, double per_radius, double kappa) {
    return cylinder_errors(is_along_x, with(cylinder(is_along_x ? 0.0 : 90.0), contrast), contrast,
                           per_radius, kappa);
}

/// Directions and polarisations relative to the wave e_x e^{-kappa z}.
constexpr std::pair<Vec3, Vec3> probes[] = {{{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}},
                                            {{0.0, 0.0, -1.0}, {1.0, 0.0, 0.0}},
                                            {{1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}},
                                            {{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}},
                                            {{0.6, 0.0, 0.8}, {0.8, 0.0, -0.6}}};

static double sphere_error(const Body& body, Contrast contrast, double per_radius, double kappa) {
    constexpr double width = 12.0;
    ElasticBody cells(body, per_radius, kappa, {width, width, width});
    const ElasticSphere exact(kappa, contrast);
    constexpr Vec3 x{0.8, -0.6, 0.0}, y{0.48, 0.64, -0.6}, z{0.36, 0.48, 0.8}; // not aligned
    const auto turned = [&](Vec3 v) { return v.x * x + v.y * y + v.z * z; };
    const auto wave = [](double k, Vec3 direction, Vec3 polarisation) {
        return [=](Vec3 r) { return std::exp(k * dot(r, direction)) * polarisation; };
    };
    Difference all;
    for (const auto& [direction, polarisation] : probes)
        all.add(
            cells.work(wave(-kappa, z, x), wave(kappa, turned(direction), turned(polarisation))),
            exact.scattered(direction, polarisation));
    return all.relative();
}

/// Required at five spacings per radius. At a contrast of 400 and kappa = 1, 5.2 % (cylinder) and
/// 4.6 % (sphere) are observed, of which 1 % is the wave on this grid.
static double allowed(double contrast) {
    return contrast <= 10.0 ? 0.03 : 0.06;
}

/// Integral of e^{kappa v.r} over the unit sphere and over the unit disk.
static double over_sphere(double x) {
    return x > 0.0 ? 4.0 * pi * (x * std::cosh(x) - std::sinh(x)) / (x * x * x) : 4.0 * pi / 3.0;
}
static double over_disk(double x) {
    return x > 1e-9 ? 2.0 * pi * bessel_i(1, x) / x : pi;
}

TEST_CASE("series for elastic bodies equal Born's approximation at small contrasts", "[verify]") {
    // The contrast times the integral of the product of the waves' strains, or displacements.
    constexpr double small = 1e-6;
    const double kappa = GENERATE(0.5, 2.0);
    const Contrast contrast = GENERATE(Contrast{1.0 + small, 1.0}, Contrast{1.0, 1.0 + small});
    const bool is_modulus = contrast.modulus > 1.0;
    const double square = kappa * kappa, margin = 1e-4 * small; // contrasts squared, and rounding
    for (const double angle : {0.4, 1.3, pi}) {
        const double disk =
            small * square * over_disk(2.0 * kappa * std::abs(std::cos(0.5 * angle)));
        CHECK(along_cylinder(kappa, contrast, angle) ==
              Approx(disk * (is_modulus ? std::cos(angle) : 1.0)).margin(margin));
        CHECK(across_cylinder(kappa, contrast, angle) ==
              Approx(disk * square * std::cos(is_modulus ? 2.0 * angle : angle)).margin(margin));
    }
    const ElasticSphere sphere(kappa, contrast);
    for (const auto& [direction, polarisation] : probes) {
        const Vec3 change = direction - Vec3{0.0, 0.0, 1.0};
        const double of_modulus = -polarisation.x * direction.z - direction.x * polarisation.z;
        CHECK(sphere.scattered(direction, polarisation) ==
              Approx(small * square * over_sphere(kappa * norm(change)) *
                     (is_modulus ? of_modulus : polarisation.x))
                  .margin(margin));
    }
}

TEST_CASE("an elastic cylinder scatters shear waves as the closed form", "[verify]") {
    const double kappa = GENERATE(0.5, 1.0); // at 3 mm and 5 m/s: 130 and 270 Hz
    const double modulus = GENERATE(0.1, 0.3, 3.0, 10.0, 50.0, 400.0);
    const bool is_along_x = GENERATE(true, false);
    const Errors found = cylinder_errors(is_along_x, {modulus, 1.0}, 5.0, kappa);
    CAPTURE(kappa, modulus, is_along_x, found.along, found.across);
    CHECK(found.along < allowed(modulus));
    CHECK(found.across < allowed(modulus));
}

TEST_CASE("a dense or viscous elastic cylinder scatters shear waves as the closed form",
          "[verify][extended]") {
    const double kappa = 0.5;
    SECTION("dense") {
        const Errors found = cylinder_errors(false, {10.0, 1.9}, 5.0, kappa);
        CAPTURE(found.along, found.across);
        CHECK(found.along < allowed(10.0));
        CHECK(found.across < allowed(10.0));
    }
    SECTION("viscous") {
        // The modulus at growth s is mu + viscosity s. No viscosity of a laminate is exact at all
        // frequencies: 2.2 % are observed in a body that is more viscous, not stiffer, at 1 and
        // 0.6 % at 0.1. As viscous as stiff, 5.1 % are observed at a contrast of 400.
        const double growth_1_s = kappa / body_radius_m * 5.0;
        const auto [modulus, viscous] = GENERATE(table<double, double>(
            {{1.0, 0.1}, {1.0, 1.0}, {10.0, 3.0}, {10.0, 10.0}, {400.0, 400.0}}));
        Body body = with(cylinder(90.0), {modulus, 1.0});
        body.viscosity_Pa_s = viscous * solid_mu_Pa / growth_1_s;
        const Errors found = cylinder_errors(false, body, {modulus + viscous, 1.0}, 5.0, kappa);
        CAPTURE(modulus, viscous, found.along, found.across);
        CHECK(found.along < allowed(modulus));
        CHECK(found.across < allowed(modulus));
    }
}

TEST_CASE("an elastic sphere scatters shear waves as the closed form", "[verify]") {
    const double kappa = 1.0, modulus = GENERATE(0.3, 10.0, 400.0);
    const double found = sphere_error(with(sphere(), {modulus, 1.0}), {modulus, 1.0}, 5.0, kappa);
    CAPTURE(modulus, found);
    CHECK(found < allowed(modulus));
}

TEST_CASE("a viscous elastic sphere scatters shear waves as the closed form",
          "[verify][extended]") {
    const double kappa = 0.5, viscous = 1.0; // times the modulus of the solid at this growth
    Body body = with(sphere(), {10.0, 1.0});
    body.viscosity_Pa_s = viscous * solid_mu_Pa / (kappa / body_radius_m * 5.0);
    const double found = sphere_error(body, {10.0 + viscous, 1.0}, 5.0, kappa);
    CAPTURE(found);
    CHECK(found < allowed(10.0));
}

TEST_CASE("an inclined elastic cylinder scatters shear waves as the closed form",
          "[long][verify][extended]") {
    // The middle of a cylinder that is twelve radii long; the effect of its ends decays as
    // e^{-kappa r} around it. A much stiffer one carries their motion along.
    constexpr double kappa = 1.0, half_length = 1.5;
    const double modulus = GENERATE(0.1, 10.0);
    Body body = with(cylinder(0.0), {modulus, 1.0});
    std::get<Cylinder>(body.shape).length_m = 12.0 * body_radius_m;
    std::get<Cylinder>(body.shape).azimuth_deg = 40.0;
    std::get<Cylinder>(body.shape).inclination_deg = 30.0;
    const double c = std::cos(40.0 * pi / 180.0), s = std::sin(40.0 * pi / 180.0),
                 level = std::cos(30.0 * pi / 180.0), down = std::sin(30.0 * pi / 180.0);
    const Axes axes{{c * level, s * level, down}, {-s, c, 0.0}, {-c * down, -s * down, level}};
    ElasticBody cells(body, 5.0, kappa, {16.0, 16.0, 14.0});
    Difference along, across;
    for (const double angle : {0.0, 0.5 * pi, pi}) {
        const auto counts = [&](Vec3 r) { return std::abs(dot(r, axes.axis)) < half_length; };
        along.add(
            cells.work(axes.along_wave(kappa, 0.3), axes.along_wave(kappa, 0.3 + angle), counts),
            2.0 * half_length * along_cylinder(kappa, {modulus, 1.0}, angle));
        across.add(
            cells.work(axes.across_wave(kappa, 0.3), axes.across_wave(kappa, 0.3 + angle), counts),
            2.0 * half_length * across_cylinder(kappa, {modulus, 1.0}, angle));
    }
    CAPTURE(modulus, along.relative(), across.relative());
    CHECK(along.relative() < allowed(modulus));
    CHECK(across.relative() < allowed(modulus));
}

TEST_CASE("errors of elastic cylinders decrease with first order in the spacing",
          "[long][verify]") {
    // Root mean square over positions on the grid, which scatter by 15 %. First order is a factor
    // of 0.5; observed 0.46 to 0.54 for stiff bodies.
    const double modulus = GENERATE(0.1, 3.0, 50.0, 400.0);
    const auto mean = [=](double per_radius) {
        Errors sum;
        for (const double y : {0.0, 0.25, 0.5}) {
            const Errors at = cylinder_errors(true, with(cylinder(0.0), {modulus, 1.0}),
                                              {modulus, 1.0}, per_radius, 0.5, {0.0, y, 0.0});
            sum.along += at.along * at.along;
            sum.across += at.across * at.across;
        }
        return Errors{std::sqrt(sum.along / 3.0), std::sqrt(sum.across / 3.0)};
    };
    const Errors coarse = mean(10.0), fine = mean(20.0);
    CAPTURE(modulus, coarse.along, coarse.across, fine.along, fine.across);
    CHECK(fine.along < 0.56 * coarse.along);
    CHECK(fine.across < 0.56 * coarse.across);
}

} // namespace test_elastic_scattering
