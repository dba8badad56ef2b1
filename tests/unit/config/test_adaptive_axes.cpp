// SPDX-License-Identifier: BSD-3-Clause
#include "unit/config/jobs.hpp"

namespace test_adaptive_axes {

using namespace shearwake;
using namespace shearwake::test;

constexpr std::string_view refined = R"([sweep]
"load.modulation.am_frequency_Hz" = { refine = [100, 800], column = "eta_period_1", tolerance = 0.002 }
load.peak_Pa = [50, 100]
)";

static Plan plan_of(std::string_view more, const config::AxisPoints& points = {},
                    std::vector<config::Override> overrides = {}) {
    return config::read_job(plain_and(more), "job.toml", overrides, nullptr, nullptr, points).plan;
}

static Texts of_axis(const std::string& axis) {
    return diagnostics_of(
        plain_and("[sweep]\n\"load.modulation.am_frequency_Hz\" = { " + axis + " }\n"));
}

TEST_CASE("an adaptive axis has the points of the first round", "[config][adapt]") {
    const Plan plan = plan_of(refined);
    CHECK(plan.cases.size() == 18);
    REQUIRE(plan.adaptive.size() == 1);
    const AdaptiveAxis& axis = plan.adaptive.front();
    CHECK(axis.key == "load.modulation.am_frequency_Hz");
    CHECK(axis.goal == AdaptiveAxis::Goal::refine);
    CHECK(axis.first == 100.0);
    CHECK(axis.last == 800.0);
    CHECK(axis.tolerance == 0.002);
    CHECK(axis.smallest_step == Approx(0.7));
    CHECK(plan.cases[2].settings[0].value == std::variant<double, std::string>(187.5));
}

TEST_CASE("an adaptive axis takes the points that results ask for", "[config][adapt]") {
    const Plan plan =
        plan_of(refined, {{"load.modulation.am_frequency_Hz", {100.0, 300.0, 800.0}}});
    CHECK(plan.cases.size() == 6);
    // Ids depend on the values alone.
    CHECK(plan.cases[0].id == plan_of(refined).cases[0].id);
}

TEST_CASE("a key of an adaptive axis and the whole axis can be overridden", "[config][adapt]") {
    const std::string key = "sweep.\"load.modulation.am_frequency_Hz\"";
    CHECK(plan_of(refined, {}, {{key + ".tolerance", "0.01"}}).adaptive.front().tolerance == 0.01);
    const Plan plain = plan_of(refined, {}, {{key, "[200, 400]"}});
    CHECK(plain.adaptive.empty());
    CHECK(plain.cases.size() == 4);
    const Plan shallow = plan_of(refined, {}, {{"sweep.load.modulation.am_frequency_Hz", "[200]"}});
    CHECK(shallow.cases.size() == 2);
}

TEST_CASE("mistakes in adaptive axes are reported", "[config][adapt]") {
    const std::string rest = ", column = \"eta_period_1\", tolerance = 2";
    CHECK_FALSE(any_contains(of_axis("refine = [100, 800]" + rest), "sweep"));
    CHECK_FALSE(any_contains(of_axis("find = \"minimum\", in = [100, 800]" + rest), "sweep"));
    CHECK_FALSE(
        any_contains(of_axis("find = \"crossing\", level = 0.3, in = [100, 800]" + rest), "sweep"));
    const auto [axis, said] = GENERATE_REF(table<std::string, std::string>({
        {"find = \"crossing\", in = [100, 800]" + rest, "requires a level"},
        {"refine = [800, 100]" + rest, "two ascending numbers"},
        {"refine = [100, 800], in = [1, 2]" + rest, "in"},
        {"refine = [100, 800], column = \"eta_period_1\"", "tolerance"},
        {"refine = [100, 800], tolerance = 1", "column"},
        {"refine = [100, 800], initial = 2" + rest, "initial"},
        {"refine = [100, 800], smallest_step = 0" + rest, "smallest_step"},
        {"refine = [-100, 800]" + rest, "am_frequency_Hz"},
    }));
    CHECK(any_contains(of_axis(axis), said));
}

} // namespace test_adaptive_axes
