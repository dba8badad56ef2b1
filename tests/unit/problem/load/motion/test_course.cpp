// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/load.hpp"
#include "problem/load/motion/trajectory.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_course {

using namespace shearwake;

constexpr double pi = std::numbers::pi;

/// A square of 20 mm, anticlockwise from its lower right corner.
static Polyline square() {
    return regular_polygon({}, 0.01 * std::sqrt(2.0), 4, -0.25 * pi);
}

static bool are_near(Vec2 a, Vec2 b) {
    return norm(a - b) <= 1e-12 * 0.1; // roundings of numbers below 0.1
}

TEST_CASE("a repeated circle follows the closed form", "[course]") {
    Travel travel{Arc{{}, 0.015, 0.0, 2.0 * pi}, {}, AtEnd::repeat};
    travel.motion = ConstantSpeed{speed_of_cycle_m_s(travel, 1.0 / 70.0)};
    CHECK(cycle_s(travel) == Approx(1.0 / 70.0).epsilon(1e-14));
    CHECK(std::isinf(off_time_s({{travel}})));
    for (const double t : {0.0, 0.003, 0.0201, 0.1234}) {
        const double angle = 2.0 * pi * 70.0 * t;
        CHECK(
            are_near(position({{travel}}, t), {0.015 * std::cos(angle), 0.015 * std::sin(angle)}));
    }
}

TEST_CASE("a line back and forth is a triangle wave", "[course]") {
    const Travel travel{{{-0.01, 0.0}, {0.01, 0.0}}, ConstantSpeed{4.0}, AtEnd::back_and_forth};
    CHECK(cycle_s(travel) == Approx(0.01).epsilon(1e-14));
    // The swing of the same amplitude begins in the middle, a quarter of a period later.
    const Swing triangle{{0.01, 0.0}, 100.0, -0.5 * pi, SwingWave::triangle};
    for (const double t : {0.0, 0.0013, 0.005, 0.0061, 0.0333}) {
        CHECK(are_near(position({{travel}}, t), position({{triangle}}, t)));
        CHECK(velocity({{travel}}, t + 1e-5).x ==
              Approx(velocity({{triangle}}, t + 1e-5).x).epsilon(1e-12));
    }
}

TEST_CASE("a swing follows its sine", "[course]") {
    const Swing swing{{0.002, 0.001}, 150.0, 0.4, SwingWave::sine};
    const double t = GENERATE(0.0, 0.0017, 0.3);
    const double angle = 2.0 * pi * 150.0 * t + 0.4;
    CHECK(are_near(position({{swing}}, t), {0.002 * std::sin(angle), 0.001 * std::sin(angle)}));
    CHECK(velocity({{swing}}, t).x ==
          Approx(0.002 * 2.0 * pi * 150.0 * std::cos(angle)).epsilon(1e-11));
    CHECK(greatest_speed_m_s(Trajectory{{swing}}) ==
          Approx(std::hypot(0.002, 0.001) * 2.0 * pi * 150.0).epsilon(1e-14));
}

TEST_CASE("the focus rests at every corner of a closed path", "[course]") {
    const Travel travel{square(), ConstantSpeed{0.5}, AtEnd::repeat, {.dwell_s = 0.1}};
    CHECK(stops(travel) == 4);
    CHECK(cycle_s(travel) == Approx(4.0 * (0.02 / 0.5 + 0.1)).epsilon(1e-14));
    const auto at = [&](double t) { return position({{travel}}, t); };
    CHECK(are_near(at(0.0), {0.01, -0.01}));
    CHECK(are_near(at(0.0999), {0.01, -0.01}));
    CHECK(velocity({{travel}}, 0.05) == Vec2{});
    CHECK(are_near(at(0.12), {0.01, 0.0})); // half a side on
    CHECK(are_near(at(0.14), {0.01, 0.01}));
    CHECK(are_near(at(0.2399), {0.01, 0.01}));
    CHECK(are_near(at(0.56 + 0.12), {0.01, 0.0})); // a run later
}

TEST_CASE("an open path that is traversed once has stops only at its inner corners", "[course]") {
    const Polyline hook({{0.0, 0.0}, {0.02, 0.0}, {0.02, 0.03}}, Ends::open);
    const CornerPace pace{.dwell_s = 0.25};
    CHECK(cycle_s({hook, ConstantSpeed{1.0}, AtEnd::off, pace}) == Approx(0.3).epsilon(1e-14));
    const Travel there_and_back{hook, ConstantSpeed{1.0}, AtEnd::back_and_forth, pace};
    CHECK(stops(there_and_back) == 4); // both ends and twice the corner
    CHECK(cycle_s(there_and_back) == Approx(1.1).epsilon(1e-14));
    const auto at = [&](double t) { return position({{there_and_back}}, t); };
    CHECK(are_near(at(0.2), {0.0, 0.0}));
    CHECK(are_near(at(0.26), {0.01, 0.0}));
    CHECK(are_near(at(0.4), {0.02, 0.0}));
    CHECK(are_near(at(0.535), {0.02, 0.015}));
    CHECK(are_near(at(0.7), {0.02, 0.03}));
    CHECK(are_near(at(0.815), {0.02, 0.015}));
    CHECK(are_near(at(1.09), {0.01, 0.0}));
}

TEST_CASE("speed changes linearly around a corner", "[course]") {
    const CornerPace pace{.dwell_s = 0.0, .slow_within_m = 0.004, .slow_to = 0.25};
    const Travel travel{square(), ConstantSpeed{0.5}, AtEnd::repeat, pace};
    // 4 mm at a speed between 0.125 and 0.5 m/s take 4 mm / 0.3125 m/s.
    const double zone_s = 0.004 / 0.3125, side_s = 2.0 * zone_s + 0.012 / 0.5;
    CHECK(cycle_s(travel) == Approx(4.0 * side_s).epsilon(1e-14));
    CHECK(progress(travel, 0.0).speed_m_s == Approx(0.125).epsilon(1e-13));
    CHECK(progress(travel, zone_s).arc_m == Approx(0.004).epsilon(1e-12));
    CHECK(progress(travel, 0.5 * side_s).speed_m_s == Approx(0.5).epsilon(1e-14));
    CHECK(progress(travel, side_s).arc_m == Approx(0.02).epsilon(1e-12));
    CHECK(progress(travel, side_s - 1e-9).speed_m_s == Approx(0.125).epsilon(1e-6));
    // By symmetry about the middle of the side.
    CHECK(progress(travel, side_s - 0.4 * zone_s).arc_m ==
          Approx(0.02 - progress(travel, 0.4 * zone_s).arc_m).epsilon(1e-12));
}

TEST_CASE("a draw frequency includes the rests at corners", "[course]") {
    const CornerPace pace =
        GENERATE(CornerPace{}, CornerPace{.dwell_s = 0.02},
                 CornerPace{.dwell_s = 0.01, .slow_within_m = 0.003, .slow_to = 0.2});
    Travel travel{square(), {}, AtEnd::repeat, pace};
    travel.motion = ConstantSpeed{speed_of_cycle_m_s(travel, 0.125)};
    CHECK(cycle_s(travel) == Approx(0.125).epsilon(1e-14));
    const double t = GENERATE(0.01, 0.0777, 0.11);
    CHECK(are_near(position({{travel}}, t + 8.0 * 0.125), position({{travel}}, t)));
}

TEST_CASE("the velocity along a path with corners is the position's derivative", "[course]") {
    const CornerPace pace{.dwell_s = 0.01, .slow_within_m = 0.004, .slow_to = 0.25};
    const Trajectory t{{Travel{square(), ConstantSpeed{0.5}, AtEnd::repeat, pace}}};
    for (const double at : {0.013, 0.03, 0.055, 0.2}) { // slow, fast; never across a corner
        const double h = 1e-6; // differences of a parabola are exact but for rounding, 1e-17 / h
        const Vec2 slope = (0.5 / h) * (position(t, at + h) - position(t, at - h));
        CHECK(norm(velocity(t, at) - slope) < 1e-9);
    }
}

TEST_CASE("a focus rests at its points and jumps between them", "[course]") {
    const Polyline path({{0.0, 0.0}, {0.01, 0.0}, {0.01, 0.02}}, Ends::open);
    Travel travel{path, Rests{{0.0, 0.01, 0.03}, {0.002, 0.003, 0.007}, {0.2, 1.0, 0.5}}};
    const auto at = [&](double t_s) { return position({{travel}}, t_s); };
    const Vec2 first, second{0.01, 0.0}, third{0.01, 0.02};
    travel.at_end = AtEnd::repeat;
    CHECK(cycle_s(travel) == 0.007);
    for (const double pass_s : {0.0, 0.007, 0.7}) {
        CHECK(are_near(at(pass_s + 0.0019), first));
        CHECK(are_near(at(pass_s + 0.0029), second));
        CHECK(are_near(at(pass_s + 0.0031), third));
        CHECK(level({{travel}}, pass_s + 0.0025) == 1.0);
    }
    CHECK(are_near(at(0.002), second)); // the end of a rest is not part of it
    CHECK(norm(velocity({{travel}}, 0.0025)) == 0.0);
    travel.at_end = AtEnd::back_and_forth;
    CHECK(cycle_s(travel) == 0.014);
    CHECK(are_near(at(0.0109), third));
    CHECK(are_near(at(0.0115), second));
    CHECK(are_near(at(0.0125), first));
    CHECK(level({{travel}}, 0.0105) == 0.5);
    travel.at_end = AtEnd::hold;
    CHECK(are_near(at(1.0), third));
    CHECK(std::isinf(off_time_s({{travel}})));
    travel.at_end = AtEnd::off;
    CHECK(off_time_s({{travel}}) == 0.007);
    std::vector<double> before, after, within;
    add_smooth_pieces({{travel}}, 0.00199, before);
    add_smooth_pieces({{travel}}, 0.00201, after);
    add_smooth_pieces({{travel}}, 0.00299, within);
    CHECK(before != after);
    CHECK(after == within);
}

TEST_CASE("only a straight path at one speed has a single wake", "[course]") {
    const Curve line = {{0.0, 0.0}, {0.1, 0.0}}, circle = Arc{{}, 0.01, 0.0, 2.0 * pi};
    CHECK(has_constant_velocity({{Hold{}}}));
    CHECK(has_constant_velocity({{Hold{}, Travel{line, ConstantSpeed{7.0}}}}));
    CHECK_FALSE(has_constant_velocity({{Travel{circle, ConstantSpeed{7.0}}}}));
    CHECK_FALSE(has_constant_velocity({{Travel{line, OscillatingSpeed{7.0, 2.0, 100.0, 0.0}}}}));
    CHECK_FALSE(has_constant_velocity({{Travel{line, ConstantSpeed{7.0}, AtEnd::back_and_forth}}}));
    CHECK_FALSE(has_constant_velocity({{Swing{{0.001, 0.0}, 100.0}}}));
}

TEST_CASE("a drawn pattern on a moving centre is a modulation, a drawn path is none", "[course]") {
    const Travel path{square(), ConstantSpeed{0.1}, AtEnd::repeat};
    const Travel pattern{Arc{{}, 0.002, 0.0, 2.0 * pi}, ConstantSpeed{2.0 * pi * 0.002 * 200.0},
                         AtEnd::repeat};
    CHECK(modulation_frequency_Hz({"STM", {{path}}, {}}) == std::nullopt);
    CHECK(modulation_frequency_Hz({"STP", {{path, pattern}}, {}}).value() ==
          Approx(200.0).epsilon(1e-13));
    CHECK(modulation_frequency_Hz({"LM", {{Hold{}, Swing{{0.001, 0.0}, 90.0}}}, {}}) == 90.0);
}

} // namespace test_course
