// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/expected_cases.hpp"

namespace shearwake::schedule {

double shared_s(const Case& c, const Case* before, int ranks, cost::CaseCosts& costs) {
    if (before && before->scene().medium == c.scene().medium && before->domain == c.domain)
        return 0.0;
    return cost::shared_seconds_on(costs.of(c), ranks, costs.machine());
}

std::vector<ExpectedCase> expected_cases(const std::vector<const PlannedCase*>& cases, int ranks,
                                         int teams, cost::CaseCosts& costs) {
    std::vector<ExpectedCase> all;
    const auto in_turn = static_cast<std::size_t>(teams); // the teams take similar cases
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const Case& c = cases[i]->physics;
        const Case* before = i >= in_turn ? &cases[i - in_turn]->physics : nullptr;
        const cost::CaseCost& cost = costs.of(c);
        all.push_back({engine_name(c.solver), cost.kinds,
                       cost::seconds_on(cost, ranks, teams, costs.machine()) +
                           shared_s(c, before, ranks, costs)});
    }
    return all;
}

} // namespace shearwake::schedule
