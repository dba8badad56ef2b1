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

TEST_CASE("a case costs what its parts cost", "[costs]") {
    const cost::Machine machine{
        .message_s = 1e-6, .transposed_B_s = 1e9, .file_s = 0.5, .written_B_s = 1e8};
    const cost::CaseCost cost{.compute_s = 100.0,
                              .transposes = 1000.0,
                              .plane_B = 1e6,
                              .written_B = 1e7,
                              .useful_ranks = 100};
    CHECK(cost::seconds_on(cost, 1, 1, machine) == Approx(100.0 + 0.5 + 0.1));
    // 1000 transposes of 10 messages and a tenth of a plane; four teams write.
    CHECK(cost::seconds_on(cost, 10, 4, machine) ==
          Approx(10.0 + 1000.0 * (10e-6 + 1e5 / 1e9) + 0.5 + 0.4));
    // 100 slabs on 30 ranks: four on the fullest.
    CHECK(cost::seconds_on(cost, 30, 1, machine) ==
          Approx(4.0 + 1000.0 * (30e-6 + 1e6 / 30.0 / 1e9) + 0.5 + 0.1));
    // More ranks than slabs bring nothing.
    CHECK(cost::seconds_on(cost, 1000, 1, machine) == cost::seconds_on(cost, 100, 1, machine));
}

TEST_CASE("each step of engine pstd exchanges six fields there and back, nine where it is lossy",
          "[costs]") {
    PlannedCase planned{"a",
                        test::moving_focus(test::half_space(test::tissue()), ConstantSpeed{7.0}),
                        {},
                        false,
                        ""};
    planned.physics.time = {20, 1e-3};
    const auto cost_in = [&](Precision precision, double viscosity_Pa_s) {
        planned.physics.scene().medium.layers[0].loss = KelvinVoigt{viscosity_Pa_s};
        planned.physics.solver = PstdOptions{.time_step_s = 1e-5, .precision = precision};
        return cost::CaseCosts({&planned}, {}).of(planned.physics);
    };
    const cost::CaseCost in_double = cost_in(Precision::double_precision, 1.0),
                         in_single = cost_in(Precision::single_precision, 1.0),
                         lossless = cost_in(Precision::double_precision, 0.0);
    CHECK(in_double.transposes == 2.0 * 9.0 * 2000.0);
    CHECK(lossless.transposes == 2.0 * 6.0 * 2000.0);
    CHECK(in_single.plane_B == 0.5 * in_double.plane_B);
    CHECK(lossless.plane_B == in_double.plane_B);
    CHECK(lossless.compute_s < in_double.compute_s);
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
            .insert(costs.of(p->physics).compute_s);
    // The steps are those of the probed ones, and the meshes are nearly the same for all.
    CHECK(*of_others.begin() > 0.8 * *of_probed.begin());
    CHECK(*of_others.rbegin() < 1.25 * *of_probed.rbegin());
}

} // namespace test_deadline
