// SPDX-License-Identifier: BSD-3-Clause
// Rigid bodies in engine "spectral": the constraint, the energy, symmetries,
// and the limit of a very stiff elastic body.
#include "engines/spectral/bodies/section_markers.hpp"
#include "support/displacement_at.hpp"
#include "support/rigid_cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace test_spectral_rigid {

using namespace shearwake;
using test::Along;
using test::bone_case;
using test::last_frame;
using test::relative_l2;
using test::step_through;
using test::with_step;

/// The displacement at a point, smoothed across the axis as at a marker.
static Vec3 displacement_at(const Case& c, const spectral::Stepper& stepper, Vec3 at_m,
                            bool along_x) {
    const auto& options = std::get<SpectralOptions>(c.solver);
    const Comm alone = Comm::world().split(Comm::world().rank());
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, alone);
    return test::displacement_at(c.domain, spectral::choose_mesh(c, options, *options.time_step_s),
                                 spectral::WaveVectors(c.domain, slabs.share()),
                                 stepper.now().data(), at_m, [&](double kx, double ky) {
                                     const double width = spectral::marker_smoothing *
                                                          c.domain.spacing_m * (along_x ? ky : kx);
                                     return std::exp(-0.5 * width * width);
                                 });
}

TEST_CASE("markers of a rigid body move rigidly", "[verify]") {
    const auto axis = GENERATE(Along::x, Along::y);
    const bool along_x = axis == Along::x;
    Case c = bone_case(axis, 0.5);
    SECTION("free") {}
    SECTION("fixed") {
        c.scene.medium.bodies[0].fixed = true;
    }
    SECTION("with a sponge") {
        c.domain.sponge_m = 8e-3;
    }
    SECTION("next to an elastic body, with iterations") {
        c.scene.medium.bodies.push_back(test::elastic_neighbour());
    }
    const Body bone = c.scene.medium.bodies[0];
    step_through(c, 30, [&](const spectral::Stepper& stepper) {
        if (stepper.step() % 15 != 0) return;
        const std::vector<double>& q = stepper.bodies().position();
        double worst = 0.0, largest = 0.0;
        const auto markers = spectral::section_markers(
            bone, along_x ? spectral::Endless::along_x : spectral::Endless::along_y,
            c.domain.spacing_m,
            spectral::level_spacing_m(
                spectral::choose_mesh(c, std::get<SpectralOptions>(c.solver), 50e-6),
                bounds(bone).low_m.z, bounds(bone).high_m.z));
        for (std::size_t i = 0; i < markers.size(); i += 3) {
            const auto [across_m, down_m] = markers[i];
            for (const double along_m : {-3.3e-3, 5.1e-3}) {
                const Vec3 at = bone.centre_m + (along_x ? Vec3{along_m, across_m, down_m}
                                                         : Vec3{across_m, along_m, down_m});
                const Vec3 u = displacement_at(c, stepper, at, along_x);
                const Vec3 rigid = along_x
                                       ? Vec3{q[0], q[1] + down_m * q[3], q[2] - across_m * q[3]}
                                       : Vec3{q[1] + down_m * q[3], q[0], q[2] - across_m * q[3]};
                worst = std::max(worst, norm(u - rigid));
            }
            Vec3 surface = bone.centre_m;
            surface.z = 0.0;
            largest = std::max(largest, norm(displacement_at(c, stepper, surface, along_x)));
        }
        CAPTURE(stepper.step(), worst, largest, q[2]);
        CHECK(worst < 1e-11 * largest); // rounding, amplified by the condition of G, up to 1e4
        CHECK((q[2] != 0.0) == !bone.fixed);
    });
}

TEST_CASE("energy of a lossless medium with a rigid body is conserved", "[verify]") {
    const double step_s = GENERATE(25e-6, 50e-6, 200e-6);
    const auto axis = GENERATE(Along::x, Along::y);
    Case c = bone_case(axis, 0.0);
    std::get<SpectralOptions>(c.solver).time_step_s = step_s;
    SECTION("free and dense") {}
    SECTION("free and light") {
        c.scene.medium.bodies[0].density_kg_m3 = 300.0;
    }
    SECTION("fixed") {
        c.scene.medium.bodies[0].fixed = true;
    }
    test::check_conserved_energy(c, step_s, 7);
}

TEST_CASE("a rigid body along x is equivalent to one along y", "[verify]") {
    const Case x = bone_case(Along::x, 0.5), y = bone_case(Along::y, 0.5);
    const auto of_x = last_frame(x), of_y = last_frame(y);
    std::vector<double> turned;
    for (std::ptrdiff_t i = 0; i < y.domain.nx; ++i)
        for (std::ptrdiff_t j = 0; j < y.domain.ny; ++j)
            turned.push_back(of_x[static_cast<std::size_t>(j * x.domain.ny + i)]);
    CHECK(relative_l2(turned, of_y) < 1e-10); // sums in a different order
}

TEST_CASE("mirror image of a rigid body yields the mirror image of the field",
          "[verify][extended]") {
    Case c = bone_case(Along::y, 0.5);
    const auto frame = last_frame(c);
    test::travel_of(c).path = Curve({7e-3, 2e-3}, {-7e-3, 1e-3});
    c.scene.medium.bodies[0].centre_m.x *= -1.0;
    const auto mirrored = last_frame(c);
    CHECK(test::asymmetry(c.domain, frame, mirrored) < 1e-10 * test::largest(frame)); // required
}

TEST_CASE("a rigid body across the periodic edge is the same body elsewhere",
          "[verify][extended]") {
    Case c = bone_case(Along::y, 0.5);
    const auto frame = last_frame(c);
    const std::ptrdiff_t shift = c.domain.nx / 2 - 1; // the body then crosses the edge
    const double by_m = static_cast<double>(shift) * c.domain.spacing_m;
    auto& path = test::travel_of(c).path;
    path = Curve({-7e-3 + by_m, 2e-3}, {7e-3 + by_m, 1e-3});
    c.scene.medium.bodies[0].centre_m.x += by_m;
    const auto moved = last_frame(c);
    std::vector<double> back;
    for (std::ptrdiff_t i = 0; i < c.domain.nx; ++i)
        for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j)
            back.push_back(
                moved[static_cast<std::size_t>((i + shift) % c.domain.nx * c.domain.ny + j)]);
    CHECK(relative_l2(back, frame) < 1e-9); // rounding of the phases
}

TEST_CASE("a rigid body converges as the grid is refined", "[verify][extended]") {
    // The change of the surface field due to a bone of 3 mm radius, at the points of the coarsest
    // grid, compared with a spacing of 0.3 mm.
    const bool fixed = GENERATE(false, true);
    const auto effect = [&](std::ptrdiff_t times) {
        Case c = with_step(bone_case(Along::y, 0.5), 25e-6);
        c.domain = {32 * times, 4 * times, 1.2e-3 / static_cast<double>(times), 0.0};
        c.time.frames = 15;
        c.scene.medium.bodies[0].fixed = fixed;
        Case none = c;
        none.scene.medium.bodies.clear();
        const auto with = last_frame(c), without = last_frame(none);
        std::vector<double> change;
        for (std::ptrdiff_t i = 0; i < c.domain.nx; i += times)
            for (std::ptrdiff_t j = 0; j < c.domain.ny; j += times) {
                const auto at = static_cast<std::size_t>(i * c.domain.ny + j);
                change.push_back(with[at] - without[at]);
            }
        return change;
    };
    const auto finest = effect(4);
    const double at_2 = relative_l2(effect(2), finest), at_3 = relative_l2(effect(3), finest);
    CAPTURE(fixed, at_2, at_3);
    // Observed: .005 and .002 if it is free, .003 and .002 if it is fixed.
    CHECK(at_2 < 0.01);
    CHECK(at_3 < 0.005);
}

} // namespace test_spectral_rigid
