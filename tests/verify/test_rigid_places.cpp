// SPDX-License-Identifier: BSD-3-Clause
// Rigid bodies in engine "spectral": several bodies, at the base, light ones, and reciprocity.
#include "support/rigid_cases.hpp"

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
    // Until a wave has travelled between them: 1 ms at 5 m/s; the near field is 1e-2.
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
