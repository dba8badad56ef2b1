// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/memory.hpp"
#include "schedule/run/arrangement.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <set>

namespace test_teams {

using namespace shearwake;

constexpr double plenty_B = 1e12;

struct Cases {
    std::vector<PlannedCase> planned;
    std::vector<const PlannedCase*> pointers() const {
        std::vector<const PlannedCase*> all;
        for (const PlannedCase& p : planned)
            all.push_back(&p);
        return all;
    }
};

static double memory_B(const Case& c, int ranks) {
    return pipeline::plan_case(c, ranks, *engines::make_engine(c.solver)).needs.memory_per_rank_B();
}

static Cases alike(int count) {
    Cases cases;
    const Case c = test::moving_focus(test::half_space(test::tissue(1500.0)), ConstantSpeed{7.0});
    for (int i = 0; i < count; ++i)
        cases.planned.push_back({std::to_string(i), c, {}, false, ""});
    return cases;
}

static schedule::TeamLayout laid_out(const Cases& cases, int ranks, int wanted, double memory_B) {
    cost::CaseCosts costs({}, 0.0);
    return schedule::choose_teams(cases.pointers(), ranks, wanted, memory_B, costs);
}

TEST_CASE("many small cases run in parallel, and a single case gets all ranks", "[teams]") {
    const schedule::TeamLayout many = laid_out(alike(400), 4, 0, plenty_B);
    CHECK(many.ranks_per_case == 1);
    CHECK(many.teams == 4);
    const schedule::TeamLayout one = laid_out(alike(1), 4, 0, plenty_B);
    CHECK(one.ranks_per_case == 4);
    CHECK(one.teams == 1);
}

TEST_CASE("a wanted team size is kept, and ranks left over are idle", "[teams]") {
    const schedule::TeamLayout layout = laid_out(alike(10), 5, 2, plenty_B);
    CHECK(layout.ranks_per_case == 2);
    CHECK(layout.teams == 2);
    std::vector<int> sizes(3, 0); // the last one: of idle ranks
    for (int rank = 0; rank < 5; ++rank)
        ++sizes[static_cast<std::size_t>(layout.team_of(rank))];
    CHECK(sizes == std::vector<int>{2, 2, 1});
    CHECK(laid_out(alike(3), 2, 64, plenty_B).ranks_per_case == 2); // no more than there are
    CHECK(laid_out({}, 3, 0, plenty_B).teams == 3);                 // nothing to do
}

TEST_CASE("teams grow until the cases fit into a rank's memory", "[teams][slow]") {
    const Cases cases = alike(400);
    const Case& c = cases.planned.front().physics;
    const double on_one_B = memory_B(c, 1), on_four_B = memory_B(c, 4);
    REQUIRE(on_four_B < on_one_B);
    CHECK(laid_out(cases, 4, 0, on_one_B).ranks_per_case == 1);
    CHECK(laid_out(cases, 4, 0, on_four_B).ranks_per_case == 4);
    // Where none fits, each fails by itself.
    CHECK(laid_out(cases, 4, 0, 1.0).ranks_per_case == 1);
}

TEST_CASE("the first of adjacent cases of a medium computes its transfer function", "[teams]") {
    Cases pairs = alike(6);
    for (std::size_t i = 0; i < 6; ++i)
        pairs.planned[i].physics.scene.medium.layers[0].c_s_m_s =
            5.0 + 1e-4 * static_cast<double>(i / 2);
    cost::CaseCosts costs({}, 0.0);
    const engines::Resources& one = costs.resources(pairs.planned[0].physics);
    REQUIRE(one.shared_work > 0.0);
    const std::vector<double> work = schedule::work_per_rank(pairs.pointers(), 1, costs);
    REQUIRE(work.size() == 6);
    for (std::size_t i = 0; i < 6; ++i)
        CHECK(work[i] == Approx(one.work + (i % 2 == 0 ? one.shared_work : 0.0)).epsilon(1e-9));
    CHECK(schedule::work_per_rank(pairs.pointers(), 4, costs)[0] ==
          Approx(0.25 * work[0]).epsilon(1e-9));
    // No more ranks than rows.
    CHECK(schedule::work_per_rank(pairs.pointers(), 1000000, costs)[0] ==
          Approx(work[0] / one.useful_ranks).epsilon(1e-9));
}

TEST_CASE("a sweep lasts as long as its longest case or its busiest team", "[teams]") {
    CHECK(schedule::sweep_length({}, 4) == 0.0);
    CHECK(schedule::sweep_length({1.0, 1.0, 1.0}, 2) == 2.0);
    CHECK(schedule::sweep_length({1.0, 1.0, 1.0}, 1) == 3.0);
    CHECK(schedule::sweep_length({9.0, 1.0, 1.0, 1.0}, 4) == 9.0);
    // Three cases on two ranks last two cases on one rank each, and 3/2 on both.
    CHECK(laid_out(alike(3), 2, 0, plenty_B).ranks_per_case == 2);
    CHECK(laid_out(alike(7), 2, 0, plenty_B).ranks_per_case == 1); // 4 instead of 7/2
}

TEST_CASE("long cases come first, and cases of one medium are adjacent", "[teams]") {
    Cases cases = alike(6);
    cases.planned[1].physics.domain.nx = 512; // long
    cases.planned[2].physics.scene.medium.layers[0].c_s_m_s = 4.0;
    cases.planned[4].physics.scene.medium.layers[0].c_s_m_s = 4.0;
    cost::CaseCosts costs({}, 0.0);
    const auto order = schedule::order_of_work(cases.pointers(), costs);
    CHECK(order.front() == 1);
    CHECK(std::set<std::size_t>(order.begin(), order.end()).size() == 6);
    const auto place = [&](std::size_t index) {
        return std::find(order.begin(), order.end(), index) - order.begin();
    };
    CHECK(std::abs(place(2) - place(4)) == 1); // the softer medium's two
}

TEST_CASE("cases too large for one rank's memory get more ranks", "[teams]") {
    const auto cases = alike(400);
    const Case& c = cases.planned[0].physics;
    const double on_two_B = memory_B(c, 2);
    REQUIRE(on_two_B < memory_B(c, 1));
    CHECK(laid_out(cases, 4, 0, on_two_B).ranks_per_case == 2);
}

TEST_CASE("too large teams and idle ranks are named", "[teams]") {
    CHECK(schedule::excessive_team(0, 2).empty());
    CHECK(schedule::excessive_team(2, 2).empty());
    CHECK(schedule::excessive_team(8, 2) ==
          "--ranks-per-case 8 exceeds the 2 ranks of the run: a team has 2");
    CHECK(schedule::idle_ranks_text({.ranks_per_case = 1, .teams = 2}, 2, 1) ==
          ", 1 rank stays idle");
    CHECK(schedule::idle_ranks_text({.ranks_per_case = 2, .teams = 3}, 7, 1) ==
          ", 5 ranks stay idle");
    CHECK(schedule::idle_ranks_text({.ranks_per_case = 3, .teams = 2}, 8, 9) ==
          ", 2 ranks stay idle");
    CHECK(schedule::idle_ranks_text({.ranks_per_case = 2, .teams = 3}, 6, 3).empty());
}

} // namespace test_teams
