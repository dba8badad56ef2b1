// SPDX-License-Identifier: BSD-3-Clause
// Rigid bodies in engine "spectral": several bodies, at the base, light ones, reciprocity,
// complete layers, and volumes inside and beside them.
#include "support/rigid_cases.hpp"
#include "support/volume_store.hpp"

#include <catch2/catch.hpp>

using namespace shearwake;
using test::Along;
using test::bone_case;
using test::last_frame;
using test::relative_l2;
using test::step_through;

TEST_CASE("exchanging source and receiver above rigid bodies preserves the trace", "[verify]") {
    Case c = bone_case(GENERATE(Along::x, Along::y), 0.5);
    // Resolves the footprint of the receiver, which ends before the edges.
    c.domain = {48, 48, 0.75e-3, 0.0};
    const Vec2 places[2] = {{-4e-3, 1e-3}, {5e-3, 3e-3}};
    std::vector<double> recorded[2]; // for all frames
    for (int i = 0; i < 2; ++i) {
        c.scene().load.modulation.trajectory = {{Hold{places[i]}}};
        const test::FrameStore frames = test::frames_of(c);
        const Vec2 there = places[1 - i];
        for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
            const auto& frame = frames.at(n);
            recorded[i].push_back(0.0);
            for (std::ptrdiff_t x = 0; x < c.domain.nx; ++x)
                for (std::ptrdiff_t y = 0; y < c.domain.ny; ++y)
                    recorded[i].back() +=
                        frame[static_cast<std::size_t>(x * c.domain.ny + y)] *
                        pressure(c.scene().load.footprint, c.domain.x_m(x) - there.x,
                                 c.domain.y_m(y) - there.y);
        }
    }
    CHECK(relative_l2(recorded[0], recorded[1]) < 1e-6); // required
}

TEST_CASE("two rigid bodies far apart act independently", "[verify]") {
    // Their axes are 32 spacings apart, which a wave travels in more than the 1 ms of the case;
    // what remains is the almost static near field.
    Case both = bone_case(Along::y, 0.5);
    both.domain.nx = 64;
    both.time.frames = 10;
    const Body one = both.scene().medium.bodies[0];
    Body other = one;
    other.name = "other";
    other.centre_m.x -= 32.0 * both.domain.spacing_m;
    other.density_kg_m3 = 1200.0;
    both.scene().medium.bodies = {one, other};
    Case first = both, second = both, none = both;
    first.scene().medium.bodies = {one};
    second.scene().medium.bodies = {other};
    none.scene().medium.bodies.clear();
    auto expected = last_frame(first);
    const auto more = last_frame(second), less = last_frame(none);
    for (std::size_t i = 0; i < expected.size(); ++i)
        expected[i] += more[i] - less[i];
    const auto frame = last_frame(both);
    CHECK(relative_l2(frame, less) > 0.05);
    CHECK(relative_l2(frame, expected) < 5e-3);
}

TEST_CASE("a rigid body that reaches the base is held by it", "[verify]") {
    Case c = bone_case(Along::y, 0.5);
    c.scene().medium.bodies[0].centre_m.z = 9e-3 + 1e-12; // of a radius of 3 mm in 12 mm
    const auto frame = last_frame(c);
    c.scene().medium.bodies[0].fixed = true;
    CHECK(last_frame(c) == frame);
}

TEST_CASE("a rigid body that is too light for a stable motion is rejected", "[verify]") {
    Case c = bone_case(Along::y, 0.5);
    c.scene().medium.bodies[0].density_kg_m3 = 1.0;
    std::get<SpectralOptions>(c.solver).time_step_s = 25e-6;
    CHECK_THROWS_WITH(step_through(c, 1, [](const spectral::Stepper&) {}),
                      Catch::Contains("so much lighter than the material that it replaces"));
    c.scene().medium.bodies[0].fixed = true;
    CHECK_NOTHROW(step_through(c, 1, [](const spectral::Stepper&) {}));
}

TEST_CASE("volumes inside a rigid body show its motion and no strain", "[verify]") {
    Case c = bone_case(Along::y, 0.5);
    c.domain = {64, 8, 0.6e-3, 0.0};
    c.time.frames = 16;
    c.record.volumes_s = {c.time.frame_s(15)};
    c.record.volume_fields = {VolumeField::u, VolumeField::strain};
    c.measure.at_s = c.time.duration_s();
    test::VolumeStore store;
    engines::make_engine(c.solver)->run(c, Comm::world().split(Comm::world().rank()), store);
    std::vector<double> q;
    step_through(c, std::lround(1.6e-3 / 50e-6),
                 [&](const spectral::Stepper& stepper) { q = stepper.bodies().position(); });
    const Body& bone = c.scene().medium.bodies[0];
    const double radius_m = std::get<Cylinder>(bone.shape).radius_m;
    double worst_u = 0.0, beside = 0.0, inside = 0.0, outside = 0.0;
    for (std::size_t level = 0; level < store.z_m().size(); ++level)
        for (std::ptrdiff_t i = 0; i < c.domain.nx; ++i) {
            const double across_m = c.domain.x_m(i) - bone.centre_m.x;
            const double down_m = store.z_m()[level] - bone.centre_m.z;
            const double r_m = std::hypot(across_m, down_m);
            const auto at = static_cast<std::size_t>(i * c.domain.ny);
            const auto value = [&](std::size_t field, std::size_t component) {
                return store.at(0, field, component, level)[at];
            };
            double strain = 0.0;
            for (std::size_t component = 0; component < 6; ++component)
                strain = std::max(strain, std::abs(value(1, component)));
            const double difference = std::max(std::abs(value(0, 0) - q[1] - down_m * q[3]),
                                               std::abs(value(0, 2) - q[2] + across_m * q[3]));
            if (r_m < radius_m) {
                inside = std::max(inside, strain);
                worst_u = std::max(worst_u, difference);
            } else if (r_m < radius_m + 0.3 * c.domain.spacing_m) {
                outside = std::max(outside, strain);
                beside = std::max(beside, difference);
            }
        }
    CAPTURE(worst_u, beside, q[2], inside, outside);
    CHECK(worst_u < 1e-12 * std::abs(q[2])); // rounding
    CHECK(inside == 0.0);
    // Within 0.3 spacings of the body the material follows it up to the strain over a spacing.
    CHECK(beside < outside * c.domain.spacing_m);
    CHECK(outside > 1e-6);
}

namespace {

/// A slab as wide as the domain, from 5 to 9 mm in 12 mm of tissue.
Case slab_case(double viscosity_Pa_s) {
    Case c = bone_case(Along::y, viscosity_Pa_s);
    c.scene().medium.bodies[0] = {.name = "slab",
                                  .shape = Box{{c.domain.extent_x_m(), 1.0, 4e-3}},
                                  .centre_m = {0.0, 0.0, 7e-3},
                                  .density_kg_m3 = 1900.0,
                                  .rigid = true};
    return c;
}

} // namespace

TEST_CASE("a rigid slab is equivalent to a rigid base at its top", "[verify]") {
    Case c = test::with_step(slab_case(0.5), 12.5e-6);
    c.time.frames = 30;
    SECTION("marked as rigid") {}
    SECTION("rigid because it is stiff") {
        c.scene().medium.bodies[0].rigid = false;
        c.scene().medium.bodies[0].c_s_m_s = 1619.0;
        c.scene().medium.bodies[0].c_p_m_s = 3517.0;
    }
    SECTION("next to an elastic body, with iterations") {
        // Far below the surface, behind the slab.
        c.scene().medium.bodies.push_back({.name = "lump",
                                           .shape = Ellipsoid{{4e-3, 4e-3, 1e-3}},
                                           .centre_m = {0.0, 0.0, 10.5e-3},
                                           .density_kg_m3 = 1200.0,
                                           .c_s_m_s = 10.0});
    }
    SECTION("with a sponge, against the same with the base") {
        c.domain.sponge_m = 8e-3;
    }
    Case layer = c;
    layer.scene().medium.bodies.clear();
    layer.scene().medium.layers[0].thickness_m = 5e-3;
    if (c.domain.sponge_m == 0.0) layer.solver = LayeredOptions{};
    const double difference = relative_l2(last_frame(c), last_frame(layer));
    CAPTURE(difference);
    CHECK(difference < 2e-3); // required
}

TEST_CASE("energy of a lossless medium with a rigid slab is conserved", "[verify]") {
    const double step_s = GENERATE(25e-6, 200e-6);
    const Case c = test::with_step(slab_case(0.0), step_s);
    const auto end = std::lround(2.2e-3 / step_s) + 2; // of the load and of its correction
    double after = 0.0, worst = 0.0;
    step_through(c, std::lround(14e-3 / step_s), [&](spectral::Stepper& stepper) {
        if (stepper.step() < end || (stepper.step() > end && stepper.step() % 9 != 0)) return;
        const double energy_J = stepper.energy().energy_J;
        if (stepper.step() == end) after = energy_J;
        worst = std::max(worst, std::abs(energy_J / after - 1.0));
    });
    CAPTURE(step_s, after, worst);
    CHECK(after > 0.0);
    CHECK(worst < 1e-8); // as without bodies
}
