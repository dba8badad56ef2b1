// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/deadline.hpp"

#include "base/error.hpp"
#include "schedule/cost/case_costs.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

namespace test_deadline {

using namespace shearwake;

TEST_CASE("a walltime is given in seconds or as Slurm writes it", "[deadline]") {
    CHECK(schedule::parse_walltime("90") == 90.0);
    CHECK(schedule::parse_walltime("1:30") == 90.0);
    CHECK(schedule::parse_walltime("2:00:01") == 7201.0);
    CHECK(schedule::parse_walltime("1-12:00:00") == 129600.0);
    for (const char* wrong : {"", "0", "-5", "1-12", "1:2:3:4", "1h", "1:", ":1", "UNLIMITED", "1 ",
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

TEST_CASE("the time of a case is the sum of its parts", "[costs]") {
    cost::Rates rates;
    rates.add({"steps", 1e3, 1, 1e-6, false});
    rates.add({"table", 1e3, 1, 1e-3, true});
    rates.add({"steps", 1e3, 20, 2e-6, false});
    const engines::Resources cost{.work = {{"steps", 1e3, 1e5}, {"table", 1e3, 10.0, true}},
                                  .useful_ranks = 100};
    CHECK(cost::shares_work(cost));
    const cost::CaseTime alone = cost::time_of(cost, 1, rates);
    CHECK(alone.own_s == Approx(100.0));
    CHECK(alone.shared_s == Approx(10.0));
    CHECK(alone.origin == cost::Origin::probed);
    // 100 slabs on 30 ranks: four on the fullest. The nearest rate is that of 20 ranks.
    const cost::CaseTime on_30 = cost::time_of(cost, 30, rates);
    CHECK(on_30.own_s == Approx(2.0 * 4.0));
    CHECK(on_30.shared_s == Approx(10.0 * 4.0 / 100.0));
    CHECK(on_30.origin == cost::Origin::similar);
    // A measured rate contains the imbalance.
    CHECK(cost::time_of(cost, 20, rates).own_s == Approx(200.0 / 20.0));
    // More ranks than slabs bring nothing.
    CHECK(cost::time_of(cost, 1000, rates).own_s == cost::time_of(cost, 100, rates).own_s);
    CHECK(cost::time_of(cost, 1, {}).origin == cost::Origin::unknown);
    // The files, whose rate only a complete case shows, do not make a time unknown.
    const engines::Resources files{.work = {{"steps", 1e3, 1.0}, {"files", 1e5, 1.0}}};
    CHECK(cost::time_of(files, 1, rates).origin == cost::Origin::measured);
}

TEST_CASE("twelve cases of a sweep are measured, the others use the step of the nearest",
          "[costs][slow]") {
    std::vector<PlannedCase> planned;
    for (int i = 0; i < 40; ++i) {
        Case c = test::moving_focus(test::half_space(test::tissue()), ConstantSpeed{7.0});
        c.time = {20, 1e-3};
        c.solver = SpectralOptions{};
        c.scene().load.modulation.envelope = {{SineGain{.frequency_Hz = 20.0 + 20.0 * i}}};
        planned.push_back({std::to_string(i), c, {}, false, ""});
    }
    std::vector<const PlannedCase*> cases;
    for (const PlannedCase& p : planned)
        cases.push_back(&p);
    cost::CaseCosts costs(cases, {});
    int probed = 0;
    for (const PlannedCase* p : cases)
        probed += costs.is_probed(p->physics) ? 1 : 0;
    CHECK(probed == 12);
    CHECK(costs.is_probed(planned.front().physics));
    CHECK(costs.is_probed(planned.back().physics));
    std::set<double> of_probed, of_others;
    for (const PlannedCase* p : cases)
        (costs.is_probed(p->physics) ? of_probed : of_others)
            .insert(costs.time(p->physics, 1).own_s);
    // The steps are those of the probed ones, and the meshes are nearly the same for all.
    CHECK(*of_others.begin() > 0.8 * *of_probed.begin());
    CHECK(*of_others.rbegin() < 1.25 * *of_probed.rbegin());
}

} // namespace test_deadline
