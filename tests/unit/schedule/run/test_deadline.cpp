// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/deadline.hpp"

#include "base/error.hpp"
#include "schedule/cost/case_costs.hpp"
#include "schedule/run/progress.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>

namespace test_deadline {

using namespace shearwake;

TEST_CASE("a walltime is given in seconds or as Slurm writes it", "[deadline]") {
    CHECK(schedule::parse_walltime("90") == 90.0);
    CHECK(schedule::parse_walltime("1:30") == 90.0);
    CHECK(schedule::parse_walltime("2:00:01") == 7201.0);
    CHECK(schedule::parse_walltime("1-12:00:00") == 129600.0);
    CHECK(schedule::parse_walltime("1-12:30") == 131400.0);
    CHECK(schedule::parse_walltime("0-2") == 7200.0);
    for (const char* wrong : {"", "0", "-5", "1-", "1:2:3:4", "1h", "1:", ":1", "UNLIMITED", "1 ",
                              "99999999999", "1-1-1:00:00"})
        CHECK_THROWS_AS(schedule::parse_walltime(wrong), UsageError);
}

TEST_CASE("without a limit there is always time", "[deadline]") {
    const schedule::Deadline none;
    CHECK_FALSE(none.exists());
    CHECK(std::isinf(none.left_s()));
    const schedule::Deadline hour("1:00:00", Comm::world());
    CHECK(hour.exists());
    CHECK(hour.limit_s() == 3600.0);
    CHECK(hour.left_s() <= 3540.0); // a minute is kept
}

TEST_CASE("a case that cannot finish in time is not started, unless no other case could ever start",
          "[deadline]") {
    const schedule::Deadline hour("1:00:00", Comm::world());
    CHECK(hour.lets_begin(600.0, 601.0));
    CHECK_FALSE(hour.lets_begin(600.0, 599.0));
    CHECK(hour.lets_begin(7200.0, 3500.0));       // saved at the end, then resumed
    CHECK_FALSE(hour.lets_begin(7200.0, 2000.0)); // the next run has more of it
    CHECK_FALSE(hour.lets_begin(3000.0, 2990.0)); // fits into a whole hour
    CHECK(hour.lets_begin(3300.0, 3310.0));
    CHECK(schedule::Deadline().lets_begin(1e9));
    CHECK(hour.lets_begin(60.0)); // by its clock
    CHECK_FALSE(schedule::Deadline("10", Comm::world()).lets_begin(8.9, 8.0));
}

TEST_CASE("the remaining time is that of the remaining work at the mean speed", "[remaining]") {
    CHECK(schedule::time_left_s(30.0, 10.0, 40.0).value() == 90.0);
    CHECK(schedule::time_left_s(30.0, 40.0, 40.0).value() == 0.0);
    CHECK(schedule::time_left_s(0.0, 0.0, 0.0).value() == 0.0);
    CHECK_FALSE(schedule::time_left_s(30.0, 0.0, 40.0)); // nothing is done
}

TEST_CASE(
    "the time steps of twelve cases of a sweep are chosen, the others use the step of the nearest",
    "[costs][slow]") {
    std::vector<PlannedCase> planned;
    for (int i = 0; i < 40; ++i) {
        Case c = test::moving_focus(test::half_space(test::tissue()), ConstantSpeed{7.0});
        c.domain = {64, 48, 1.5e-3, 0.0};
        c.time = {5, 1e-3};
        c.solver = SpectralOptions{};
        c.scene.load.modulation.envelope = {{SineGain{.frequency_Hz = 20.0 + 20.0 * i}}};
        planned.push_back({std::to_string(i), c, {}, false, ""});
    }
    std::vector<const PlannedCase*> cases;
    for (const PlannedCase& p : planned)
        cases.push_back(&p);
    cost::CaseCosts costs(cases, std::numeric_limits<double>::infinity());
    int chosen = 0;
    for (const PlannedCase* p : cases)
        chosen += costs.is_step_chosen(p->physics) ? 1 : 0;
    CHECK(chosen == 12);
    CHECK(costs.is_step_chosen(planned.front().physics));
    CHECK(costs.is_step_chosen(planned.back().physics));
    std::set<double> of_chosen, of_others;
    for (const PlannedCase* p : cases)
        (costs.is_step_chosen(p->physics) ? of_chosen : of_others)
            .insert(costs.resources(p->physics).work);
    // The steps are those of the chosen ones, and the meshes are nearly the same for all.
    CHECK(*of_others.begin() > 0.8 * *of_chosen.begin());
    CHECK(*of_others.rbegin() < 1.25 * *of_chosen.rbegin());
}

} // namespace test_deadline
