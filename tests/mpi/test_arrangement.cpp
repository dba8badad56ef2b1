// SPDX-License-Identifier: BSD-3-Clause
// All ranks of a run must compute the same cases in the same order on the same teams.
#include "pipeline/memory.hpp"
#include "schedule/run/arrangement.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>

namespace test_arrangement {

using namespace shearwake;

namespace {

/// Three cases of each medium, whose tables make it worthwhile that one team computes all three.
Plan plan_of(int media) {
    Plan plan;
    Case c = test::moving_focus(test::half_space(test::tissue()), ConstantSpeed{7.0});
    for (int medium = 0; medium < media; ++medium) {
        c.scene().medium.layers[0].c_s_m_s = 4.0 + 0.01 * medium;
        for (int i = 0; i < 3; ++i)
            plan.cases.push_back({std::to_string(plan.cases.size()), c, {}, false, ""});
    }
    return plan;
}

/// Costs as ranks may have measured them: rank 0 tables that take longer than the frames, the
/// others tables so fast that they do not matter.
cost::CaseCosts costs_of(const std::vector<const PlannedCase*>& cases, int rank) {
    cost::CaseCosts costs(cases, {});
    cost::Rates rates;
    for (const engines::Work& part : costs.of(cases.front()->physics).work)
        rates.add({part.kind, part.size, 1,
                   !part.is_shared ? 1e-9
                   : rank > 0      ? 1e-18
                                   : 1e-3,
                   false});
    costs.use(rates);
    return costs;
}

std::vector<double> flat(const schedule::Arrangement& all) {
    std::vector<double> values(all.numbers.begin(), all.numbers.end());
    for (const schedule::Bundle& bundle : all.bundles) {
        values.push_back(static_cast<double>(bundle.first));
        values.push_back(static_cast<double>(bundle.count));
    }
    values.insert(values.end(),
                  {static_cast<double>(all.layout.ranks_per_case),
                   static_cast<double>(all.layout.teams), all.layout.seconds, all.layout.busy});
    return values;
}

} // namespace

TEST_CASE("all ranks arrange a sweep alike although they measured different times", "[mpi]") {
    const Comm world = Comm::world();
    // As many media as teams can share evenly: otherwise one team of all ranks may be faster.
    const Plan plan = plan_of(1 + 4 * world.size());
    std::vector<std::size_t> work;
    std::vector<const PlannedCase*> cases;
    for (std::size_t n = 3; n < plan.cases.size(); ++n) { // the first three are complete
        work.push_back(n);
        cases.push_back(&plan.cases[n]);
    }
    cost::CaseCosts costs = costs_of(cases, world.rank());
    const schedule::Arrangement all = schedule::arrange(plan, work, 0, 1e12, costs, world);

    std::vector<double> of_root = flat(all);
    world.broadcast(of_root);
    CHECK(flat(all) == of_root);

    std::vector<bool> seen(plan.cases.size(), false);
    REQUIRE(all.numbers.size() == work.size());
    for (std::size_t n = 0; n < all.numbers.size(); ++n) {
        seen.at(all.numbers[n]) = true;
        CHECK(all.cases[n] == &plan.cases[all.numbers[n]]);
    }
    for (const std::size_t number : work)
        CHECK(seen[number]);
    std::size_t bundled = 0;
    for (const schedule::Bundle& bundle : all.bundles)
        bundled += bundle.count;
    CHECK(bundled == work.size());

    // The measured times matter: with its own, each other rank would divide the cases otherwise.
    if (world.rank() > 0)
        CHECK_FALSE(schedule::bundles_of(all.cases, all.layout, costs) == all.bundles);
}

TEST_CASE("the team size that is best with the measured rates is measured as well", "[mpi]") {
    ::setenv("SHEARWAKE_CACHE", "off", 1);
    const Comm world = Comm::world();
    const Plan plan = plan_of(1);
    const std::vector<const PlannedCase*> cases = {&plan.cases.front()};
    cost::CaseCosts costs(cases, {});
    int calls = 0;
    cost::measure_rates(costs, cases, [&] { return ++calls == 1 ? world.size() : 1; }, 1e12, world,
                        {.report = [](const std::string&) {}});
    ::unsetenv("SHEARWAKE_CACHE");
    CHECK(calls == (world.size() == 1 ? 2 : 3));
    for (const int size : {1, world.size()})
        for (const engines::Work& part : costs.of(plan.cases.front().physics, size).work)
            if (pipeline::can_be_probed(part) && part.amount() > 0.0) {
                INFO(part.kind);
                CHECK(costs.rates().of(part, size).origin == cost::Origin::probed);
            }
}

} // namespace test_arrangement
