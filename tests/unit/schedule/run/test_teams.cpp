// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/memory.hpp"
#include "schedule/run/arrangement.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <set>

namespace test_teams {

using namespace shearwake;

namespace {

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

double memory_B(const Case& c, int ranks) {
    return pipeline::plan_case(c, ranks, *engines::make_engine(c.solver)).needs.memory_per_rank_B();
}

Cases alike(int count) {
    Cases cases;
    const Case c = test::moving_focus(test::half_space(test::tissue(1500.0)), ConstantSpeed{7.0});
    for (int i = 0; i < count; ++i)
        cases.planned.push_back({std::to_string(i), c, {}, false, ""});
    return cases;
}

schedule::TeamLayout laid_out(const Cases& cases, int ranks, int wanted, double memory_B) {
    cost::CaseCosts costs(cases.pointers(), {});
    return schedule::choose_teams(cases.pointers(), ranks, wanted, memory_B, costs);
}

} // namespace

TEST_CASE("many small cases run in parallel, and a single case gets all ranks", "[teams]") {
    const schedule::TeamLayout many = laid_out(alike(400), 4, 0, plenty_B);
    CHECK(many.ranks_per_case == 1);
    CHECK(many.teams == 4);
    const schedule::TeamLayout one = laid_out(alike(1), 4, 0, plenty_B);
    CHECK(one.ranks_per_case == 4);
    CHECK(one.teams == 1);
}

TEST_CASE("a wanted team size is kept, and ranks left over join the last team", "[teams]") {
    const schedule::TeamLayout layout = laid_out(alike(10), 5, 2, plenty_B);
    CHECK(layout.ranks_per_case == 2);
    CHECK(layout.teams == 2);
    std::vector<int> sizes(2, 0);
    for (int rank = 0; rank < 5; ++rank)
        ++sizes[static_cast<std::size_t>(layout.team_of(rank))];
    CHECK(sizes == std::vector<int>{2, 3});
    CHECK(laid_out(alike(3), 2, 64, plenty_B).ranks_per_case == 2); // no more than there are
    CHECK(laid_out({}, 3, 0, plenty_B).teams >= 1);                 // nothing to do
}

TEST_CASE("teams grow until the cases fit into a rank's memory", "[teams][slow]") {
    const Cases cases = alike(400);
    const Case& c = cases.planned.front().physics;
    const double on_one_B = memory_B(c, 1), on_four_B = memory_B(c, 4);
    REQUIRE(on_four_B < on_one_B);
    CHECK(laid_out(cases, 4, 0, on_one_B).ranks_per_case == 1);
    CHECK(laid_out(cases, 4, 0, on_four_B).ranks_per_case == 4);
    // Where none fits, the fastest layout lets each fail by itself.
    CHECK(laid_out(cases, 4, 0, 1.0).ranks_per_case == 1);
}

TEST_CASE("every medium of a sweep costs its own transfer function", "[teams]") {
    Cases same = alike(300), different = alike(300), pairs = alike(300);
    for (std::size_t i = 0; i < 300; ++i) {
        different.planned[i].physics.scene().medium.layers[0].c_s_m_s =
            5.0 + 1e-4 * static_cast<double>(i);
        pairs.planned[i].physics.scene().medium.layers[0].c_s_m_s =
            5.0 + 1e-4 * static_cast<double>(i / 2);
    }
    cost::CaseCosts costs(same.pointers(), {});
    const cost::CaseTime one = costs.time(same.planned[0].physics, 1);
    REQUIRE(one.shared_s > 0.0);
    CHECK(laid_out(same, 1, 1, plenty_B).seconds ==
          Approx(300.0 * one.own_s + one.shared_s).epsilon(1e-9));
    CHECK(laid_out(different, 1, 1, plenty_B).seconds ==
          Approx(300.0 * (one.own_s + one.shared_s)).epsilon(1e-9));
    CHECK(laid_out(pairs, 1, 1, plenty_B).seconds ==
          Approx(300.0 * (one.own_s + 0.5 * one.shared_s)).epsilon(1e-9));
    // Both teams compute the function of a medium that they share.
    CHECK(laid_out(same, 2, 1, plenty_B).seconds ==
          Approx(150.0 * one.own_s + one.shared_s).epsilon(1e-9));
}

TEST_CASE("a team that has one case more than the others determines the time", "[teams]") {
    Cases three = alike(3);
    for (std::size_t i = 0; i < 3; ++i)
        three.planned[i].physics.scene().medium.layers[0].c_s_m_s =
            5.0 + 1e-4 * static_cast<double>(i);
    const double one_s = laid_out({{three.planned.front()}}, 1, 1, plenty_B).seconds;
    const schedule::TeamLayout two = laid_out(three, 2, 1, plenty_B);
    CHECK(two.seconds == Approx(2.0 * one_s).epsilon(1e-3)); // the media differ by as much
    CHECK(two.busy == Approx(0.75).epsilon(1e-3));
    CHECK(laid_out(three, 2, 0, plenty_B).ranks_per_case == 2); // so all ranks share each case
}

TEST_CASE("long cases come first, and cases of one medium are adjacent", "[teams]") {
    Cases cases = alike(6);
    cases.planned[1].physics.domain.nx = 512; // long
    cases.planned[2].physics.scene().medium.layers[0].c_s_m_s = 4.0;
    cases.planned[4].physics.scene().medium.layers[0].c_s_m_s = 4.0;
    cost::CaseCosts costs(cases.pointers(), {});
    const auto order = schedule::order_of_work(cases.pointers(), 1, costs);
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
    // Excess ranks join the last team.
    CHECK(schedule::idle_ranks_text({.ranks_per_case = 2, .teams = 3}, 7, 3).empty());
}

} // namespace test_teams
