// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/case_groups.hpp"

#include <algorithm>
#include <functional>
#include <unordered_map>

namespace shearwake::schedule {
namespace {

/// Equal for cases with the same medium and grid.
std::size_t hash_of(const Case& c) {
    std::size_t hash = static_cast<std::size_t>(c.domain.nx * 4099 + c.domain.ny);
    for (const Layer& layer : c.scene().medium.layers)
        for (const double value : {layer.thickness_m, layer.density_kg_m3, layer.c_s_m_s})
            hash = 31 * hash + std::hash<double>{}(value);
    return hash;
}

/// Whether an engine keeps data of one case for the other.
bool share_data(const Case& a, const Case& b) {
    return a.scene().medium == b.scene().medium && a.domain == b.domain && a.time == b.time &&
           a.measure.depths_m == b.measure.depths_m;
}

} // namespace

std::vector<std::size_t> groups_of(const std::vector<const PlannedCase*>& cases,
                                   cost::CaseCosts& costs) {
    std::vector<std::size_t> groups;
    std::unordered_map<std::size_t, std::vector<std::size_t>> found; // first cases by hash
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const Case& c = cases[i]->physics;
        groups.push_back(i);
        if (!(costs.of(c).shared_s > 0.0)) continue;
        std::vector<std::size_t>& firsts = found[hash_of(c)];
        const auto same = std::ranges::find_if(
            firsts, [&](std::size_t first) { return share_data(cases[first]->physics, c); });
        if (same == firsts.end())
            firsts.push_back(i);
        else
            groups.back() = *same;
    }
    return groups;
}

} // namespace shearwake::schedule
