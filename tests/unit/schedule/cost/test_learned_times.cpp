// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/learned_times.hpp"

#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

namespace test_learned_times {

using namespace shearwake;

namespace {

/// Two kinds of cases of one engine, and one of another.
std::vector<schedule::ExpectedCase> some_cases() {
    return {{"layered", "a", 10.0},
            {"layered", "a", 20.0},
            {"layered", "b", 30.0},
            {"pstd", "c", 40.0}};
}

} // namespace

TEST_CASE("estimates are not corrected before a case has been measured", "[learned]") {
    const schedule::LearnedTimes times(some_cases(), Comm::world());
    for (const std::size_t index : {0u, 1u, 2u, 3u})
        CHECK(times.factor(index) == 1.0);
    CHECK(times.left_s() == Approx(100.0));
}

TEST_CASE("the progress of a case determines its remaining time", "[learned]") {
    using Clock = std::chrono::steady_clock;
    const auto seconds = [](Clock::duration time) {
        return std::chrono::duration<double>(time).count();
    };
    schedule::LearnedTimes times(some_cases(), Comm::world());
    times.begin(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(50)); // does not count: a setup
    const auto before = Clock::now();
    times.progressed(1, 0.2); // resumed from a checkpoint
    const auto began = Clock::now();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    const auto ended = Clock::now();
    times.progressed(1, 0.3);
    const auto after = Clock::now();
    // A tenth of the case has taken between these times, and corrects the cases of this engine.
    const double least = seconds(ended - began), most = seconds(after - before);
    const auto left = [](double tenth) { return 7.0 * tenth + (10.0 + 30.0) * tenth / 2.0 + 40.0; };
    CHECK(times.left_s() >= left(least) - 1e-5); // counted in microseconds
    CHECK(times.left_s() <= left(most) + 1e-5);
    times.learn(1, 40.0, 20.0);
    times.end(1);
    CHECK(times.factor(0) == Approx(2.0)); // its partial time is not counted twice
    CHECK(times.left_s() == Approx(2.0 * 40.0 + 40.0));
}

TEST_CASE("after a tenth of a run, its remaining time is estimated within a third", "[learned]") {
    // What a case of 1000 s estimated needs: seconds of setup, and the time of each of 100 steps.
    struct Run {
        double setup_s;
        std::function<double(int)> step_s;
    };
    const auto noise = [](int n) { return 1.0 + 0.3 * std::sin(7.1 * n); };
    const Run run = GENERATE_COPY(
        Run{0.0, [](int) { return 0.2; }}, Run{5.0, [](int) { return 0.7; }}, // a long setup
        Run{0.0, noise},                                                      // a busy machine
        Run{1.0, [](int n) { return n < 4 ? 10.0 : 1.0; }});                  // a slow start
    long now_us = 0;
    schedule::LearnedTimes times({{"pstd", "a", 1000.0}}, Comm::world(), {},
                                 [&] { return now_us; });
    const auto wait = [&](double seconds) { now_us += std::lround(1e6 * seconds); };
    double total_s = run.setup_s;
    for (int n = 0; n < 100; ++n)
        total_s += run.step_s(n);
    times.begin(0);
    wait(run.setup_s);
    times.progressed(0, 0.0);
    for (int n = 0; n < 100; ++n) {
        wait(run.step_s(n));
        times.progressed(0, 0.01 * (n + 1));
        if (n + 1 < 10 || 1e-6 * static_cast<double>(now_us) < 0.1 * total_s) continue;
        const double left_s = total_s - 1e-6 * static_cast<double>(now_us);
        CAPTURE(n, left_s);
        // The noise of the last steps is allowed in addition: 1 % of the run, the time of one step.
        CHECK(std::abs(times.wall_left_s(1) - left_s) <= left_s / 3.0 + 0.01 * total_s);
    }
}

TEST_CASE("the longest running case determines the end of the run", "[learned]") {
    long now_us = 0;
    // Two teams, of which this one computes a case of 100 s; the other one would need 10 s.
    schedule::LearnedTimes times({{"pstd", "a", 100.0}, {"layered", "b", 10.0}}, Comm::world(),
                                 {2, 1}, [&] { return now_us; });
    times.begin(0);
    CHECK(times.left_s() == Approx(110.0));
    CHECK(times.wall_left_s(2) == Approx(100.0));
    times.progressed(0, 0.0);
    now_us = 20'000'000;
    times.progressed(0, 0.1);
    CHECK(times.wall_left_s(2) == Approx(180.0));
    times.end(0);
    CHECK(times.wall_left_s(1) == Approx(times.left_s()));
}

TEST_CASE("a case that is repeated after a passing failure is extrapolated anew", "[learned]") {
    long now_us = 0;
    schedule::LearnedTimes times({{"pstd", "a", 100.0}, {"pstd", "a", 100.0}}, Comm::world(), {},
                                 [&] { return now_us; });
    now_us = 1'000'000;
    times.begin(0);
    times.progressed(0, 0.0);
    now_us = 51'000'000;
    times.progressed(0, 0.25); // twice as slow as estimated, because of a failing disk
    CHECK(times.factor(1) == Approx(2.0));
    times.progressed(0, 0.0);
    CHECK(times.factor(1) == 1.0);
    now_us = 61'000'000;
    times.progressed(0, 0.1);
    CHECK(times.factor(1) == Approx(1.0));
    CHECK(times.left_s() == Approx(90.0 + 100.0));
    times.end(0);
    CHECK(times.left_s() == Approx(100.0));
}

TEST_CASE("a measured case corrects those like it, then those of its engine", "[learned]") {
    schedule::LearnedTimes times(some_cases(), Comm::world());
    times.begin(0);
    times.learn(0, 30.0, 10.0);
    times.end(0);
    CHECK(times.factor(1) == Approx(3.0));
    CHECK(times.factor(2) == Approx(3.0)); // the same engine, nothing better is known
    CHECK(times.factor(3) == 1.0);
    CHECK(times.left_s() == Approx(3.0 * 50.0 + 40.0));
    times.begin(2);
    times.learn(2, 15.0, 30.0);
    times.end(2);
    CHECK(times.factor(2) == Approx(0.5));
    CHECK(times.factor(1) == Approx(3.0)); // its own kind
    CHECK(times.left_s() == Approx(3.0 * 20.0 + 40.0));
}

TEST_CASE("cases are corrected by the sum of what those like them took", "[learned]") {
    schedule::LearnedTimes times(some_cases(), Comm::world());
    times.learn(0, 30.0, 10.0);
    times.learn(1, 10.0, 30.0);
    CHECK(times.factor(0) == Approx(1.0));
}

TEST_CASE("earlier runs are recalled by their engine", "[learned]") {
    schedule::LearnedTimes times(some_cases(), Comm::world());
    storage::JournalContents journal;
    journal.cases["x"].times = {.seconds = 8.0, .estimated_seconds = 2.0, .engine = "pstd"};
    journal.cases["y"].times = {.seconds = 8.0, .estimated_seconds = 0.0, .engine = "pstd"};
    journal.cases["z"].times = {.seconds = 8.0, .estimated_seconds = 1.0, .engine = "unknown"};
    times.load(journal);
    CHECK(times.factor(3) == Approx(4.0));
    CHECK(times.factor(0) == 1.0);
    CHECK(times.left_s() == Approx(60.0 + 160.0));
}

TEST_CASE("a postponed or claimed case is not counted as remaining", "[learned]") {
    schedule::LearnedTimes times(some_cases(), Comm::world());
    times.end(3);
    CHECK(times.left_s() == Approx(60.0));
    for (const std::size_t index : {0u, 1u, 2u})
        times.end(index);
    CHECK(times.left_s() == 0.0);
}

} // namespace test_learned_times
