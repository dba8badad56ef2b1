// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "measures/surface_sums.hpp"
#include "studies/converge/convergence.hpp"
#include "unit/config/jobs.hpp"

#include <cmath>
#include <map>

namespace test_refinement {

using namespace shearwake;
using namespace shearwake::test;
using converge::Refinement;

const std::string sweep = R"([sweep]
"load.modulation.am_frequency_Hz" = [400, 500, 600, 800]
[table]
x = "load.modulation.am_frequency_Hz"
reference = { kind = "STM" }
)";

static Plan plan_of(const std::string& more) {
    return config::read_job(plain_and(more), "job.toml").plan;
}

static Case case_of(const std::string& solver) {
    return only_case(plain_and("[solver]\n" + solver));
}

TEST_CASE("refined cases differ in one numerical parameter", "[converge]") {
    const Case c = case_of("engine = \"spectral\"\n");
    const auto all = converge::refinements(c);
    REQUIRE(all.size() == 3);
    const Domain &finer = all[0].physics.domain, &wider = all[2].physics.domain;
    CHECK(finer.spacing_m == 0.5 * c.domain.spacing_m);
    CHECK(finer.extent_x_m() == c.domain.extent_x_m());
    CHECK(all[0].order == 2.0);
    CHECK(wider.spacing_m == c.domain.spacing_m);
    CHECK(wider.extent_y_m() == 2.0 * c.domain.extent_y_m());
    const Case& smaller = all[1].physics;
    CHECK(smaller.domain == c.domain);
    CHECK(smaller.time.duration_s() == Approx(c.time.duration_s()).epsilon(1e-14));
    CHECK(smaller.time.interval_s == 0.5 * c.time.interval_s);
    CHECK(std::get<SpectralOptions>(smaller.solver).accuracy == 0.25e-3);
    CHECK(all[1].order == 2.0);
    CHECK(all[1].ratio == 2.0); // the square of the step follows the tolerance
}

TEST_CASE("refined cases measure the same region in mm", "[converge]") {
    const auto area_m2 = [](const Case& c) {
        return measures::measured_region(c.domain, c.measure).cells() * c.domain.spacing_m *
               c.domain.spacing_m;
    };
    const std::string region = GENERATE("", "region_mm = [21.3, 17.0]\n", "region_mm = \"path\"\n",
                                        "region_mm = \"palm\"\n");
    const std::string edges = GENERATE("periodic", "open");
    std::string job = plain_with("spacing_mm", "edges = \"" + edges + "\"\nspacing_mm");
    const Case c = only_case(job + "\n[measure]\n" + region);
    const double area = area_m2(c);
    const auto outline = measures::measured_outline(c.domain, c.measure);
    REQUIRE(area > 1e-4);
    for (const Refinement& r : converge::refinements(c)) {
        INFO(r.name << ", " << region);
        CHECK(area_m2(r.physics) == Approx(area).epsilon(1e-5)); // small parts are left out
        // Without a region, the spacing changes the cells at the edges of the whole plane.
        const double moved_m = region.empty() ? 0.5 * c.domain.spacing_m : 1e-12;
        const auto refined = measures::measured_outline(r.physics.domain, r.physics.measure);
        REQUIRE(refined.size() == outline.size());
        for (std::size_t n = 0; n < outline.size(); ++n)
            CHECK(norm(refined[n] - outline[n]) < moved_m);
    }
}

TEST_CASE("given time steps, and those of pstd, are halved", "[converge]") {
    const auto spectral = converge::refinements(
        case_of("engine = \"spectral\"\nspectral = { time_step_us = 20.0 }\n"));
    CHECK(std::get<SpectralOptions>(spectral[1].physics.solver).time_step_s ==
          Approx(10e-6).epsilon(1e-14));
    const auto pstd = converge::refinements(case_of("engine = \"pstd\"\n"));
    const double step_s = std::get<PstdOptions>(pstd[1].physics.solver).time_step_s.value();
    CHECK(std::abs(std::remainder(25e-6, step_s)) < 1e-12); // divides half of the frame interval
    CHECK(pstd[0].order == 2.0);
    CHECK(pstd[1].order == 2.0);
}

TEST_CASE("a study has the references of its cases, in the same refinement", "[converge]") {
    const Plan plan = plan_of(sweep);
    const auto refined = converge::refined_plan(plan, {}, 2);
    REQUIRE(refined.cases.size() == 3); // the first, the last and the reference
    CHECK(refined.cases[0].planned == &plan.cases.front());
    CHECK(refined.cases[1].planned == &plan.cases[3]);
    CHECK(refined.cases[2].planned->is_reference);
    CHECK(refined.plan.cases.size() == 12);
    std::map<std::string, const PlannedCase*> by_id;
    for (const PlannedCase& c : refined.plan.cases)
        by_id[c.id] = &c;
    CHECK(by_id.size() == 12);
    for (std::size_t i = 0; i < 3; ++i)
        CHECK(by_id.at(refined.cases[0].refined_ids[i])->reference_id ==
              refined.cases[2].refined_ids[i]);
    CHECK_THROWS_WITH(converge::refined_plan(plan, std::vector<std::string>{"no"}, 2),
                      Catch::Contains("--only no: no such case"));
}

} // namespace test_refinement
