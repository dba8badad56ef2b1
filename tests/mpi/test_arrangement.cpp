// SPDX-License-Identifier: BSD-3-Clause
// All ranks of a run must compute the same cases in the same order on the same teams.
#include "schedule/run/arrangement.hpp"
#include "support/cases.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

namespace test_arrangement {

using namespace shearwake;

/// `of_each` cases of each medium.
static Plan plan_of(int media, int of_each) {
    Plan plan;
    Case c = test::moving_focus(test::half_space(test::tissue()), ConstantSpeed{7.0});
    for (int medium = 0; medium < media; ++medium) {
        c.scene.medium.layers[0].c_s_m_s = 4.0 + 0.01 * medium;
        for (int i = 0; i < of_each; ++i)
            plan.cases.push_back({std::to_string(plan.cases.size()), c, {}, false, ""});
    }
    return plan;
}

static schedule::Arrangement arranged(const Plan& plan, std::size_t complete, int wanted) {
    std::vector<std::size_t> work;
    for (std::size_t n = complete; n < plan.cases.size(); ++n)
        work.push_back(n);
    cost::CaseCosts costs({}, 0.0);
    return schedule::arrange(plan, work, wanted, 1e12, costs, Comm::world());
}

static std::vector<double> flat(const schedule::Arrangement& all) {
    std::vector<double> values(all.numbers.begin(), all.numbers.end());
    values.insert(values.end(), all.portions.begin(), all.portions.end());
    values.insert(values.end(), all.work.begin(), all.work.end());
    values.push_back(all.layout.ranks_per_case);
    values.push_back(all.layout.teams);
    return values;
}

TEST_CASE("all ranks arrange a sweep alike", "[mpi]") {
    const Comm world = Comm::world();
    const Plan plan = plan_of(1 + 4 * world.size(), 3);
    const schedule::Arrangement all = arranged(plan, 3, 0); // the first three are complete
    std::vector<double> of_root = flat(all);
    world.broadcast(of_root);
    CHECK(flat(all) == of_root);
    REQUIRE(all.numbers.size() + 3 == plan.cases.size());
    std::vector<std::size_t> numbers = all.numbers;
    std::ranges::sort(numbers);
    for (std::size_t n = 0; n < numbers.size(); ++n) {
        CHECK(numbers[n] == n + 3);
        CHECK(all.cases[n] == &plan.cases[all.numbers[n]]);
    }
}

TEST_CASE("a team computes all cases of a medium if there are many media", "[mpi]") {
    const schedule::Arrangement all = arranged(plan_of(20, 3), 0, Comm::world().size());
    REQUIRE(all.layout.teams == 1);
    REQUIRE(all.portions.size() == 20);
    for (std::size_t n = 0; n < 20; ++n)
        CHECK(all.portions[n] == 3 * n);
}

TEST_CASE("the cases of a medium with most of the work are taken one by one", "[mpi]") {
    Plan plan = plan_of(1, 300);
    for (PlannedCase& other : plan_of(5, 2).cases) {
        other.physics.scene.medium.layers[0].density_kg_m3 = 1100.0;
        plan.cases.push_back(std::move(other));
    }
    const schedule::Arrangement all = arranged(plan, 0, 1);
    CHECK(std::ranges::count_if(
              all.portions, [&](std::size_t first) { return all.numbers[first] < 300; }) == 300);
    CHECK(arranged(plan_of(1, 5), 0, 1).portions == std::vector<std::size_t>{0, 1, 2, 3, 4});
}

} // namespace test_arrangement
