// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/expected_cases.hpp"

namespace shearwake::schedule {

double shared_s(const Case& c, const Case* before, int ranks, cost::CaseCosts& costs) {
    if (before && before->scene().medium == c.scene().medium && before->domain == c.domain)
        return 0.0;
    return cost::shared_seconds_on(costs.of(c), ranks, costs.machine());
}

std::vector<ExpectedCase> expected_cases(const std::vector<const PlannedCase*>& cases,
                                         const std::vector<Bundle>& bundles, int ranks, int teams,
                                         cost::CaseCosts& costs) {
    std::vector<ExpectedCase> all(cases.size());
    const auto in_turn = static_cast<std::size_t>(teams); // the teams take similar bundles
    for (std::size_t b = 0; b < bundles.size(); ++b) {
        const Case* before = nullptr;
        if (b >= in_turn) {
            const Bundle& last = bundles[b - in_turn];
            before = &cases[last.first + last.count - 1]->physics;
        }
        for (std::size_t n = 0; n < bundles[b].count; ++n) {
            const std::size_t place = bundles[b].first + n;
            const Case& c = cases[place]->physics;
            const cost::CaseCost& cost = costs.of(c);
            all[place] = {engine_name(c.solver), cost.kinds,
                          cost::seconds_on(cost, ranks, teams, costs.machine()) +
                              shared_s(c, before, ranks, costs)};
            before = &c;
        }
    }
    return all;
}

} // namespace shearwake::schedule
