// SPDX-License-Identifier: BSD-3-Clause
// Rigid bodies in engine "spectral": several bodies, at the base, light ones, reciprocity,
// complete layers, and volumes inside and beside them.
#include "support/rigid_cases.hpp"
#include "support/volume_store.hpp"

#include <catch2/catch.hpp>

namespace test_rigid_places {

using namespace shearwake;
using test::Along;
using test::bone_case;
using test::last_frame;
using test::relative_l2;
using test::step_through;

TEST_CASE("exchanging source and receiver above rigid bodies preserves the trace", "[verify]") {
    Case c = GENERATE(bone_case(Along::x, 0.5), bone_case(Along::y, 0.5), test::lump_case(0.5));
    // Resolves the footprint of the receiver, which ends before the edges.
    c.domain = {48, 48, 0.75e-3, 0.0};
    CHECK(test::reciprocity_error(c, {{{-4e-3, 1e-3}, {5e-3, 3e-3}}}) < 1e-6); // required
}

TEST_CASE("two rigid bodies far apart act independently", "[verify][extended]") {
    // Their axes are 32 spacings apart, which a wave travels in more than the 1 ms of the case;
    // what remains is the almost static near field.
    Case both = bone_case(Along::y, 0.5);
    both.domain.nx = 64;
    both.time.frames = 10;
    const Body one = both.scene.medium.bodies[0];
    Body other = one;
    other.name = "other";
    other.centre_m.x -= 32.0 * both.domain.spacing_m;
    other.density_kg_m3 = 1200.0;
    double tolerated = 5e-3;
    SECTION("both cross the domain") {}
    SECTION("one of them is a lump") {
        other.shape = Ellipsoid{{4e-3, 5e-3, 3e-3}};
        // The body across the domain then has the markers of a lump, as in "a long rigid lump
        // approaches an endless body".
        tolerated = 1e-2;
    }
    both.scene.medium.bodies = {one, other};
    Case first = both, second = both, none = both;
    first.scene.medium.bodies = {one};
    second.scene.medium.bodies = {other};
    none.scene.medium.bodies.clear();
    auto expected = last_frame(first);
    const auto more = last_frame(second), less = last_frame(none);
    for (std::size_t i = 0; i < expected.size(); ++i)
        expected[i] += more[i] - less[i];
    const auto frame = last_frame(both);
    CAPTURE(relative_l2(frame, less));
    CHECK(relative_l2(frame, less) > 0.05);
    CHECK(relative_l2(frame, expected) < tolerated);
}

TEST_CASE("a rigid body that reaches the base is held by it", "[verify]") {
    Case c = GENERATE(bone_case(Along::y, 0.5), test::lump_case(0.5));
    c.scene.medium.bodies[0].centre_m.z = 9e-3 + 1e-12; // of a half height of 3 mm in 12 mm
    const auto frame = last_frame(c);
    c.scene.medium.bodies[0].fixed = true;
    CHECK(last_frame(c) == frame);
    c.scene.medium.bodies.clear();
    CHECK(relative_l2(last_frame(c), frame) > 0.05);
}

TEST_CASE("a rigid body that is too light for a stable motion is rejected", "[verify]") {
    Case c = bone_case(Along::y, 0.5);
    c.scene.medium.bodies[0].density_kg_m3 = 1.0;
    std::get<SpectralOptions>(c.solver).time_step_s = 25e-6;
    CHECK_THROWS_WITH(step_through(c, 1, [](const spectral::Stepper&) {}),
                      Catch::Contains("so much lighter than the material that it replaces"));
    c.scene.medium.bodies[0].fixed = true;
    CHECK_NOTHROW(step_through(c, 1, [](const spectral::Stepper&) {}));
}

TEST_CASE("volumes inside a rigid body show its motion and no strain", "[verify]") {
    Case c = GENERATE(from_range(
        test::parameters(1, std::vector{bone_case(Along::y, 0.5), test::lump_case(0.5)})));
    const Body& bone = c.scene.medium.bodies[0];
    const bool is_lump = std::holds_alternative<Ellipsoid>(bone.shape);
    c.domain = {64, is_lump ? 56 : 8, 0.6e-3, 0.0};
    c.time.frames = 16;
    c.record.volumes_s = {c.time.frame_s(15)};
    c.record.volume_fields = {VolumeField::u, VolumeField::strain};
    c.measure.at_s = c.time.duration_s();
    const auto store = test::frames_of<test::VolumeStore>(c);
    spectral::RigidMotion motion{};
    step_through(c, std::lround(1.6e-3 / 50e-6),
                 [&](const spectral::Stepper& stepper) { motion = stepper.bodies().motions()[0]; });
    // The body and what is within 0.3 spacings of it.
    Body around = bone;
    const double near_m = 0.3 * c.domain.spacing_m;
    if (auto* shape = std::get_if<Ellipsoid>(&around.shape))
        shape->semi_axes_m = shape->semi_axes_m + Vec3{near_m, near_m, near_m};
    else
        std::get<Cylinder>(around.shape).radius_m += near_m;
    double worst_u = 0.0, beside = 0.0, inside = 0.0, outside = 0.0;
    for (std::size_t level = 0; level < store.z_m().size(); ++level)
        for (std::ptrdiff_t i = 0; i < c.domain.nx; ++i)
            for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j) {
                const Vec3 at_m{c.domain.x_m(i), c.domain.y_m(j), store.z_m()[level]};
                if (!(volume_fraction(around, at_m, {}) > 0.5)) continue;
                const auto at = static_cast<std::size_t>(i * c.domain.ny + j);
                const auto value = [&](std::size_t field, std::size_t component) {
                    return store.at(0, field, component, level)[at];
                };
                double strain = 0.0;
                for (std::size_t component = 0; component < 6; ++component)
                    strain = std::max(strain, std::abs(value(1, component)));
                const double difference = norm(Vec3{value(0, 0), value(0, 1), value(0, 2)} -
                                               motion.at(at_m - bone.centre_m));
                const bool is_inside = volume_fraction(bone, at_m, {}) > 0.5;
                double& most_strain = is_inside ? inside : outside;
                double& most_difference = is_inside ? worst_u : beside;
                most_strain = std::max(most_strain, strain);
                most_difference = std::max(most_difference, difference);
            }
    CAPTURE(is_lump, worst_u, beside, motion.shift_m.z, inside, outside);
    CHECK(worst_u < 1e-12 * std::abs(motion.shift_m.z)); // rounding
    CHECK(inside == 0.0);
    // Within 0.3 spacings of the body the material follows it up to the strain over a spacing.
    CHECK(beside < outside * c.domain.spacing_m);
    CHECK(outside > 1e-6);
}

/// A slab as wide as the domain, from 5 to 9 mm in 12 mm of tissue.
static Case slab_case(double viscosity_Pa_s) {
    Case c = bone_case(Along::y, viscosity_Pa_s);
    c.scene.medium.bodies[0] = test::rigid_slab(c);
    return c;
}

TEST_CASE("a rigid slab is equivalent to a rigid base at its top", "[verify]") {
    Case c = test::with_step(slab_case(0.5), 12.5e-6);
    c.time.frames = 30;
    SECTION("marked as rigid") {}
    SECTION("rigid because it is stiff") {
        c.scene.medium.bodies[0].rigid = false;
        c.scene.medium.bodies[0].c_s_m_s = 1619.0;
        c.scene.medium.bodies[0].c_p_m_s = 3517.0;
    }
    SECTION("next to an elastic body, with iterations") {
        // Far below the surface, behind the slab.
        c.scene.medium.bodies.push_back({.name = "lump",
                                         .shape = Ellipsoid{{4e-3, 4e-3, 1e-3}},
                                         .centre_m = {0.0, 0.0, 10.5e-3},
                                         .density_kg_m3 = 1200.0,
                                         .c_s_m_s = 10.0});
    }
    SECTION("with a sponge, against the same with the base") {
        c.domain.sponge_m = 8e-3;
    }
    Case layer = c;
    layer.scene.medium.bodies.clear();
    layer.scene.medium.layers[0].thickness_m = 5e-3;
    if (c.domain.sponge_m == 0.0) layer.solver = LayeredOptions{};
    const double difference = relative_l2(last_frame(c), last_frame(layer));
    CAPTURE(difference);
    CHECK(difference < 2e-3); // required
}

} // namespace test_rigid_places
