// SPDX-License-Identifier: BSD-3-Clause
#include "base/work_clock.hpp"

#include <catch2/catch.hpp>
#include <chrono>
#include <thread>

namespace test_work_clock {

using namespace shearwake;

namespace {

void wait_ms(int ms) {
    std::this_thread::sleep_for(std::chrono::milliseconds(ms));
}

} // namespace

TEST_CASE("the time of a stage excludes its nested stages", "[work]") {
    WorkClock clock;
    {
        const StageScope outer("outer");
        wait_ms(2);
        {
            const StageScope inner("inner");
            wait_ms(20);
        }
        wait_ms(2);
    }
    // A sleep lasts at least the requested time; its upper bound depends on the system.
    CHECK(clock.seconds("inner") >= 0.02);
    CHECK(clock.seconds("outer") >= 0.004);
    CHECK(clock.seconds("unknown") == 0.0);
    const double outer_s = clock.seconds("outer");
    wait_ms(2);
    CHECK(clock.seconds("outer") == outer_s); // time outside all stages
    CHECK(clock.seconds("") >= 0.002);
}

TEST_CASE("stages are ignored without a clock and a new clock starts at zero", "[work]") {
    {
        const StageScope ignored("stage");
        wait_ms(1);
    }
    WorkClock clock;
    CHECK(clock.seconds("stage") == 0.0);
}

} // namespace test_work_clock
