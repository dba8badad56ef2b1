// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/arrangement.hpp"

#include "support/cases.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

namespace test_bundles {

using namespace shearwake;
using schedule::Bundle;

namespace {

/// Cases of several media, those of a medium one after the other.
std::vector<PlannedCase> cases_of(int media, int of_each) {
    std::vector<PlannedCase> cases;
    Case c = test::moving_focus(test::half_space(test::tissue()), ConstantSpeed{7.0});
    for (int medium = 0; medium < media; ++medium) {
        c.scene().medium.layers[0].c_s_m_s = 4.0 + 0.01 * medium;
        for (int i = 0; i < of_each; ++i)
            cases.push_back({std::to_string(cases.size()), c, {}, false, ""});
    }
    return cases;
}

std::vector<Bundle> bundles(const std::vector<PlannedCase>& cases, int teams) {
    std::vector<const PlannedCase*> pointers;
    for (const PlannedCase& c : cases)
        pointers.push_back(&c);
    cost::CaseCosts costs(pointers, {});
    cost::Rates rates; // with tables that take longer than the frames
    for (const engines::Work& part : costs.of(cases.front().physics).work)
        rates.add({part.kind, part.size, 1, part.is_shared ? 1e-3 : 1e-9, false});
    costs.use(rates);
    return schedule::bundles_of(pointers, {.ranks_per_case = 1, .teams = teams}, costs);
}

} // namespace

TEST_CASE("a team computes all cases of a medium if the other teams have other media", "[teams]") {
    const std::vector<Bundle> all = bundles(cases_of(20, 3), 2);
    REQUIRE(all.size() == 20);
    std::vector<bool> seen(60, false);
    for (const Bundle& bundle : all) {
        CHECK(bundle.count == 3);
        CHECK(bundle.first % 3 == 0);
        for (std::size_t n = 0; n < bundle.count; ++n)
            seen.at(bundle.first + n) = true;
    }
    CHECK(std::ranges::count(seen, true) == 60);
}

TEST_CASE("all teams share the cases of a single medium", "[teams]") {
    const std::vector<Bundle> all = bundles(cases_of(1, 200), 2);
    REQUIRE(all.size() == 200);
    for (std::size_t n = 0; n < all.size(); ++n)
        CHECK(all[n] == Bundle{n, 1});
}

TEST_CASE("a medium with most of the cases is not left to one team", "[teams]") {
    std::vector<PlannedCase> cases = cases_of(1, 300);
    for (PlannedCase& other : cases_of(5, 2)) {
        other.physics.scene().medium.layers[0].density_kg_m3 = 1100.0;
        cases.push_back(std::move(other));
    }
    const std::vector<Bundle> all = bundles(cases, 4);
    const auto of_first = [](const Bundle& bundle) { return bundle.first < 300; };
    CHECK(std::ranges::count_if(all, of_first) == 300);
}

TEST_CASE("a single team takes the cases one by one", "[teams]") {
    CHECK(bundles(cases_of(2, 2), 1) == std::vector<Bundle>{{0, 1}, {1, 1}, {2, 1}, {3, 1}});
}

} // namespace test_bundles
