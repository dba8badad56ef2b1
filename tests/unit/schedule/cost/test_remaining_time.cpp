// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/remaining_time.hpp"

#include <catch2/catch.hpp>

namespace test_remaining_time {

using namespace shearwake;

namespace {

/// The remaining time of a team, with a clock that the test sets.
struct Sweep {
    long now_us = 0;
    schedule::RemainingTime times;
    explicit Sweep(std::vector<double> estimated_s)
        : times(std::move(estimated_s), Comm::world(), {}, [this] { return now_us; }) {}
};

} // namespace

TEST_CASE("before any case has ended, the estimates count", "[remaining]") {
    const Sweep sweep({10.0, 20.0, 5.0});
    CHECK(sweep.times.ratio() == 1.0);
    CHECK(sweep.times.wall_left_s(1) == Approx(35.0));
    CHECK(sweep.times.wall_left_s(5) == Approx(7.0));
}

TEST_CASE("the measured times of cases correct the estimates of others", "[remaining]") {
    Sweep sweep({10.0, 20.0, 5.0});
    sweep.times.begin(0);
    sweep.now_us = 30'000'000;
    sweep.times.learn(0, 30.0);
    sweep.times.end(0);
    CHECK(sweep.times.ratio() == Approx(3.0));
    CHECK(sweep.times.wall_left_s(1) == Approx(3.0 * (20.0 + 5.0)));
    sweep.times.end(1); // computed by another run
    CHECK(sweep.times.wall_left_s(1) == Approx(3.0 * 5.0));
}

TEST_CASE("the remaining time of a running case follows from its progress", "[remaining]") {
    Sweep sweep({1000.0, 1000.0});
    sweep.times.begin(0);
    CHECK(sweep.times.wall_left_s(2) == Approx(1000.0)); // of two teams
    sweep.times.progressed(0.2);                         // resumed from a checkpoint
    sweep.now_us = 10'000'000;
    sweep.times.progressed(0.6);
    CHECK(sweep.times.wall_left_s(1) == Approx(10.0 + 1000.0));
    sweep.times.progressed(0.1); // repeated
    sweep.now_us = 20'000'000;
    sweep.times.progressed(0.2);
    CHECK(sweep.times.wall_left_s(1) == Approx(80.0 + 1000.0));
    sweep.times.end(0);
    sweep.times.end(1);
    CHECK(sweep.times.wall_left_s(1) == 0.0);
}

TEST_CASE("the sweep takes at least as long as its longest running case", "[remaining]") {
    Sweep sweep({100.0, 10.0});
    sweep.times.begin(0);
    sweep.now_us = 30'000'000;
    CHECK(sweep.times.wall_left_s(8) == Approx(70.0));
    sweep.now_us = 200'000'000; // longer than expected
    CHECK(sweep.times.wall_left_s(1) == Approx(10.0));
}

} // namespace test_remaining_time
