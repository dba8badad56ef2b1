// SPDX-License-Identifier: BSD-3-Clause
// Rigid spheres in engine "spectral" compared with closed forms: the forces that move one, and the
// scattering of a shear wave. As for cylinders (test_rigid_references.cpp) both are evaluated at
// real exponential growth e^{st}, where the engine's implicit operator is that of a viscoelastic
// medium.
#include "engines/spectral/bodies/lump_bodies.hpp"
#include "support/spectral_cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace shearwake;

namespace {

constexpr double radius_m = 3e-3, density_kg_m3 = 1000.0, mu_Pa = 25e3;
constexpr double pi = std::numbers::pi;

/// The forces at the markers of a sphere in the middle of a large domain.
class Sphere {
public:
    /// kappa = s radius/c_s for growth e^{st}; `width` is that of the domain in radii.
    Sphere(double spacings_per_radius, double kappa, double width = 10.0) : kappa_(kappa) {
        const double spacing_m = radius_m / spacings_per_radius;
        const auto n = 2 * std::lround(0.5 * width * spacings_per_radius);
        case_ = test::small_tissue();
        Layer layer = test::tissue(1500.0, 0.0);
        layer.thickness_m = width * radius_m;
        case_.scene().medium = {{layer}, Base::rigid};
        case_.scene().medium.bodies = {
            {.name = "sphere",
             .shape = Ellipsoid{{radius_m, radius_m, radius_m}},
             .centre_m = {0.2 * spacing_m, 0.3 * spacing_m, 0.5 * width * radius_m},
             .fixed = true}};
        case_.scene().medium.bodies[0].rigid = true;
        case_.domain = {n, n, spacing_m, 0.0};
        const SpectralOptions options{.time_step_s = 1e-3, .longest_element_m = 2.0 * radius_m};
        case_.solver = options;
        const Comm alone = Comm::world().split(Comm::world().rank());
        slabs_.emplace(n, n, alone);
        const spectral::WaveVectors vectors(case_.domain, slabs_->share());
        const spectral::DepthMesh mesh = spectral::choose_mesh(case_, options, 1e-3);
        const spectral::VerticalOperator op(mesh, material(mesh, case_.scene().medium));
        const std::ptrdiff_t size = op.factor_size();
        fft::AlignedVector<Block> factors(static_cast<std::size_t>(vectors.pencils() * size));
        for (std::ptrdiff_t row = 0; row < vectors.rows(); ++row)
            for (std::ptrdiff_t block = 0; block < vectors.blocks(); ++block)
                op.factorise_implicit(vectors.waves(row, block).k, 1.0,
                                      factors.data() + (row * vectors.blocks() + block) * size);
        bodies_.emplace(case_, mesh, *slabs_, vectors, 1.0, alone, clock_);
        bodies_->assemble(op, [&](std::ptrdiff_t row, std::ptrdiff_t block, Block* pencil) {
            op.solve_implicit(factors.data() + (row * vectors.blocks() + block) * size, pencil);
        });
    }

    const std::vector<spectral::LumpBodies::Marker>& markers() const { return bodies_->markers(); }

    /// The forces [N], (x, y, z) at all markers, for a displacement of the markers [m].
    template <class Displacement>
    std::vector<double> forces(const Displacement& displacement) const {
        return bodies_->forces(values(displacement));
    }
    template <class Displacement>
    std::vector<double> values(const Displacement& displacement) const {
        std::vector<double> all;
        for (const auto& m : markers()) {
            const Vec3 u = displacement(m.offset_m);
            all.insert(all.end(), {u.x, u.y, u.z});
        }
        return all;
    }
    /// Work of the forces of a motion on this motion, in units of mu a.
    template <class Displacement>
    double stiffness(const Displacement& displacement) const {
        const std::vector<double> force = forces(displacement), motion = values(displacement);
        double work = 0.0;
        for (std::size_t i = 0; i < force.size(); ++i)
            work += force[i] * motion[i];
        return work / (mu_Pa * radius_m);
    }

private:
    /// M s^2 + K as the implicit operator of a step of 1 s with the weights .26 and 1/12.
    spectral::Background material(const spectral::DepthMesh& mesh, const Medium& medium) const {
        spectral::Background b = spectral::background_of(mesh, medium);
        const double growth_1_s2 = std::pow(kappa_ / radius_m, 2) * mu_Pa / density_kg_m3;
        for (std::size_t i = 0; i < b.density_kg_m3.size(); ++i) {
            b.density_kg_m3[i] = density_kg_m3 * growth_1_s2;
            b.lambda_Pa[i] = 1e5 * mu_Pa / 0.26; // incompressible
            b.mu_accurate_Pa[i] = 12.0 * mu_Pa;
            b.mu_stable_Pa[i] = 0.0;
            b.viscosity_Pa_s[i] = 0.0;
        }
        return b;
    }

    double kappa_;
    Case case_;
    spectral::StepClock clock_;
    std::optional<fft::SlabTransform> slabs_;
    std::optional<spectral::LumpBodies> bodies_;
};

/// Force per displacement, radius and mu on a rigid sphere full of background: Stokes (1851) and
/// its mass. The same for the torque over radius^2.
double of_force(double x) {
    return 6.0 * pi * (1.0 + x + x * x / 9.0) + 4.0 * pi / 3.0 * x * x;
}
double of_torque(double x) {
    return 8.0 * pi * (1.0 + x + x * x / 3.0) / (1.0 + x) + 8.0 * pi / 15.0 * x * x;
}

/// Force per displacement, radius and mu that holds a rigid sphere in the shear wave e^{kappa x/a},
/// polarised across x (Mazur and Bedeaux, Physica 76, 1974): 1 + kappa times the mean of the wave
/// over the surface and kappa^2/3 times its mean over the volume.
double in_wave(double x) {
    return 6.0 * pi * ((1.0 + x) * std::sinh(x) / x + (x * std::cosh(x) - std::sinh(x)) / x);
}

/// Relative errors of the mean force, of the force along an axis, and of the torques about a
/// horizontal axis and about the vertical.
struct Errors {
    double mean, along_x, about_x, about_z;
};
Errors errors(double spacings_per_radius, double kappa, double width) {
    const Sphere sphere(spacings_per_radius, kappa, width);
    double force[3], torque[3];
    for (std::size_t i = 0; i < 3; ++i) {
        force[i] = sphere.stiffness([&](Vec3) { return spectral::motions_at({})[i]; });
        torque[i] = sphere.stiffness(
            [&](Vec3 r) { return (1.0 / radius_m) * spectral::motions_at(r)[3 + i]; });
    }
    // Images of the sphere at the surface, the base and the periodic edges increase the force along
    // z and decrease the ones along x and y by half as much.
    return {(force[0] + force[1] + force[2]) / 3.0 / of_force(kappa) - 1.0,
            force[0] / of_force(kappa) - 1.0, torque[0] / of_torque(kappa) - 1.0,
            torque[2] / of_torque(kappa) - 1.0};
}

} // namespace

TEST_CASE("force on an oscillating rigid sphere agrees with the closed form", "[verify]") {
    const double kappa = GENERATE(0.5, 1.0, 2.0); // at 3 mm and 5 m/s: 130, 270 and 530 Hz
    const Errors at_6 = errors(6.0, kappa, 10.0);
    CAPTURE(kappa, at_6.mean, at_6.along_x, at_6.about_x, at_6.about_z);
    CHECK(std::abs(at_6.mean) < 0.02); // required
    CHECK(std::abs(at_6.about_x) < 0.03);
    CHECK(std::abs(at_6.about_z) < 0.03);
}

TEST_CASE("force on a rigid sphere converges as the grid is refined", "[verify]") {
    const Errors at_4 = errors(4.0, 2.0, 10.0), at_8 = errors(8.0, 2.0, 10.0);
    CAPTURE(at_4.mean, at_4.about_x, at_8.mean, at_8.about_x);
    CHECK(std::abs(at_8.mean) < 0.5 * std::abs(at_4.mean)); // first order would leave a half
    CHECK(std::abs(at_8.about_x) < 0.5 * std::abs(at_4.about_x));
}

TEST_CASE("a rigid sphere scatters a shear wave as the closed form", "[verify]") {
    // The force is the amplitude of the scattered wave far from the sphere.
    const double kappa = GENERATE(1.0, 2.0);
    const Sphere sphere(6.0, kappa, 10.0);
    const auto force = [&](const auto& wave, std::size_t component) {
        const std::vector<double> all = sphere.forces(wave);
        double sum = 0.0;
        for (std::size_t i = component; i < all.size(); i += 3)
            sum += all[i];
        return sum / (mu_Pa * radius_m);
    };
    const double level = force(
        [&](Vec3 r) {
            return Vec3{0.0, std::exp(kappa * r.x / radius_m), 0.0};
        },
        1);
    const double upright = force(
        [&](Vec3 r) {
            return Vec3{0.0, 0.0, std::exp(kappa * r.x / radius_m)};
        },
        2);
    const double upwards = force(
        [&](Vec3 r) {
            return Vec3{std::exp(-kappa * r.z / radius_m), 0.0, 0.0};
        },
        0);
    // As for the force of a motion, the images act on the mean of the directions least.
    const double mean = (level + upright + upwards) / 3.0;
    CAPTURE(kappa, level, upright, upwards, mean, in_wave(kappa));
    CHECK(mean == Approx(in_wave(kappa)).epsilon(0.03)); // required
}
