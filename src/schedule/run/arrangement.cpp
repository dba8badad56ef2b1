// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/arrangement.hpp"

#include "base/text.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <queue>
#include <unordered_map>
#include <utility>

namespace shearwake::schedule {

namespace {

/// Largest number of cases that are considered; more do not improve the layout.
constexpr std::size_t most_samples = 256;

/// Positions of a sample of cases, spread evenly.
std::vector<std::size_t> sample_of(std::size_t cases) {
    std::vector<std::size_t> sample(std::min(cases, most_samples));
    for (std::size_t i = 0; i < sample.size(); ++i)
        sample[i] = cases <= most_samples ? i : i * (cases - 1) / (most_samples - 1);
    return sample;
}

/// The number of cases that share data with each case, including itself.
std::vector<double> group_sizes(const std::vector<const PlannedCase*>& cases,
                                cost::CaseCosts& costs) {
    const std::vector<std::size_t> groups = groups_of(cases, costs);
    std::vector<double> counts(cases.size(), 0.0), sizes;
    for (const std::size_t group : groups)
        counts[group] += 1.0;
    for (const std::size_t group : groups)
        sizes.push_back(counts[group]);
    return sizes;
}

/// The part of a sweep from which its time is estimated.
struct Sample {
    const std::vector<const PlannedCase*>& cases; // of the sweep
    std::vector<std::size_t> places;              // of the sample in it
    std::vector<double> group_sizes;              // of each case of the sweep
};

/// A group stays whole (Bundle) if it takes at most this multiple of a team's share of the
/// time.
constexpr double largest_undivided_share = 1.25;

/// The number of teams that compute cases of a group, which takes `share` of the time of all cases.
double teams_of_group(double share, double cases, int busy) {
    return std::clamp(std::ceil(share * busy / largest_undivided_share), 1.0,
                      std::min(static_cast<double>(busy), cases));
}

/// Estimated times of all cases of a sweep on teams of one size, the longest first: each with its
/// part of the data that its group shares.
std::vector<double> times_of(const Sample& sample, int size, int busy, cost::CaseCosts& costs) {
    std::vector<cost::CaseTime> expected;
    double sample_s = 0.0; // with each shared part once
    for (const std::size_t place : sample.places) {
        expected.push_back(costs.time(sample.cases[place]->physics, size));
        sample_s += expected.back().own_s + expected.back().shared_s / sample.group_sizes[place];
    }
    const auto all = static_cast<double>(sample.cases.size());
    const double all_s = sample_s * all / static_cast<double>(sample.places.size());
    std::vector<double> times;
    for (std::size_t n = 0; n < sample.cases.size(); ++n) {
        const std::size_t nearest = n * sample.places.size() / sample.cases.size();
        const auto& [own_s, shared_s, origin] = expected[nearest];
        const double group = sample.group_sizes[sample.places[nearest]];
        const double teams = teams_of_group((group * own_s + shared_s) / all_s, group, busy);
        times.push_back(own_s + shared_s * teams / group);
    }
    std::ranges::sort(times, std::greater<>{});
    return times;
}

/// The time until all teams have finished, if each takes the next one of `count` items when it is
/// free. seconds(item, team): the time of an item on a team.
template <class Seconds>
double end_s(std::size_t count, int teams, const Seconds& seconds) {
    using Free = std::pair<double, std::size_t>; // from when on, the team
    std::priority_queue<Free, std::vector<Free>, std::greater<>> free;
    for (std::size_t team = 0; team < static_cast<std::size_t>(teams); ++team)
        free.emplace(0.0, team);
    double last_s = 0.0;
    for (std::size_t item = 0; item < count; ++item) {
        const auto [from_s, team] = free.top();
        free.pop();
        const double to_s = from_s + seconds(item, team);
        free.emplace(to_s, team);
        last_s = std::max(last_s, to_s);
    }
    return last_s;
}

} // namespace

TeamLayout choose_teams(const std::vector<const PlannedCase*>& cases, int ranks, int wanted,
                        double memory_per_rank_B, cost::CaseCosts& costs) {
    TeamLayout best;
    std::ptrdiff_t best_unfit = std::numeric_limits<std::ptrdiff_t>::max();
    best.seconds = std::numeric_limits<double>::infinity();
    const Sample sample{cases, sample_of(cases.size()), group_sizes(cases, costs)};
    for (int size = 1; size <= ranks; ++size) {
        if (wanted > 0 && size != std::min(wanted, ranks)) continue;
        if (wanted <= 0 && ranks % size != 0) continue;
        TeamLayout layout{.ranks_per_case = size, .teams = ranks / size};
        const int busy = std::max(
            1, static_cast<int>(std::min(static_cast<std::size_t>(layout.teams), cases.size())));
        const std::vector<double> times = times_of(sample, size, busy, costs);
        const bool useful = std::ranges::all_of(sample.places, [&](std::size_t place) {
            return size <= costs.of(cases[place]->physics).useful_ranks;
        });
        if (!useful && wanted <= 0) continue;
        layout.seconds =
            end_s(times.size(), busy, [&](std::size_t n, std::size_t) { return times[n]; });
        const double work_s = std::accumulate(times.begin(), times.end(), 0.0);
        layout.busy = layout.seconds > 0.0 ? work_s / busy / layout.seconds : 1.0;
        const auto unfit = std::ranges::count_if(sample.places, [&](std::size_t place) {
            return std::isfinite(memory_per_rank_B) &&
                   costs.memory_per_rank_B(cases[place]->physics, size) > memory_per_rank_B;
        });
        // Of layouts with similar times, small teams are preferred.
        const bool better = unfit == best_unfit && layout.seconds < 0.99 * best.seconds;
        if (unfit > best_unfit || (unfit == best_unfit && !better)) continue;
        best_unfit = unfit;
        best = layout;
    }
    if (!std::isfinite(best.seconds)) best.seconds = 0.0;
    return best;
}

std::string excessive_team(int wanted, int ranks) {
    if (wanted <= ranks) return "";
    return fmt::format("--ranks-per-case {} exceeds the {} of the run: a team has {}", wanted,
                       counted(ranks, "rank"), ranks);
}

std::string idle_ranks_text(const TeamLayout& layout, int ranks, std::size_t cases) {
    // Excess ranks join the last team, so that only teams without a case are idle.
    if (cases >= static_cast<std::size_t>(layout.teams)) return "";
    const int idle = ranks - static_cast<int>(cases) * layout.ranks_per_case;
    return fmt::format(", {} rank{} idle", idle, idle == 1 ? " stays" : "s stay");
}

std::vector<std::size_t> order_of_work(const std::vector<const PlannedCase*>& cases,
                                       int ranks_per_case, cost::CaseCosts& costs) {
    struct Rank {
        double group_seconds, seconds;
        std::size_t group;
    };
    std::vector<Rank> ranks;
    const std::vector<std::size_t> groups = groups_of(cases, costs);
    std::unordered_map<std::size_t, double> longest; // of each group
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const double seconds = costs.time(cases[i]->physics, ranks_per_case).own_s;
        longest[groups[i]] = std::max(longest[groups[i]], seconds);
        ranks.push_back({0.0, seconds, groups[i]});
    }
    for (Rank& rank : ranks)
        rank.group_seconds = longest[rank.group];
    std::vector<std::size_t> order(cases.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        if (ranks[a].group != ranks[b].group) {
            if (ranks[a].group_seconds != ranks[b].group_seconds)
                return ranks[a].group_seconds > ranks[b].group_seconds;
            return ranks[a].group < ranks[b].group;
        }
        return ranks[a].seconds > ranks[b].seconds;
    });
    return order;
}

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
        if (!cost::shares_work(costs.of(c))) continue;
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

std::vector<const PlannedCase*> cases_of(const Plan& plan,
                                         const std::vector<std::size_t>& numbers) {
    std::vector<const PlannedCase*> cases;
    for (const std::size_t number : numbers)
        cases.push_back(&plan.cases[number]);
    return cases;
}

namespace {

Arrangement arranged(const Plan& plan, const std::vector<std::size_t>& work, int ranks, int wanted,
                     double memory_per_rank_B, cost::CaseCosts& costs) {
    Arrangement all;
    const std::vector<const PlannedCase*> cases = cases_of(plan, work);
    all.layout = choose_teams(cases, ranks, wanted, memory_per_rank_B, costs);
    for (const std::size_t place : order_of_work(cases, all.layout.ranks_per_case, costs))
        all.numbers.push_back(work[place]);
    all.cases = cases_of(plan, all.numbers);
    all.bundles = bundles_of(all.cases, all.layout, costs);
    return all;
}

} // namespace

Arrangement arrange(const Plan& plan, const std::vector<std::size_t>& work, int wanted,
                    double memory_per_rank_B, cost::CaseCosts& costs, const Comm& world) {
    Arrangement all;
    std::vector<long> numbers, bundles;
    on_root(world, [&] {
        all = arranged(plan, work, world.size(), wanted, memory_per_rank_B, costs);
        numbers.assign(all.numbers.begin(), all.numbers.end());
        for (const Bundle& bundle : all.bundles)
            for (const std::size_t value : {bundle.first, bundle.count})
                bundles.push_back(static_cast<long>(value));
    });
    world.broadcast(numbers);
    world.broadcast(bundles);
    const TeamLayout layout{.ranks_per_case = world.broadcast(all.layout.ranks_per_case),
                            .teams = world.broadcast(all.layout.teams),
                            .seconds = world.broadcast(all.layout.seconds),
                            .busy = world.broadcast(all.layout.busy)};
    if (world.is_root()) return all;
    all.layout = layout;
    all.numbers.assign(numbers.begin(), numbers.end());
    all.cases = cases_of(plan, all.numbers);
    for (std::size_t n = 0; n < bundles.size(); n += 2)
        all.bundles.push_back(
            {static_cast<std::size_t>(bundles[n]), static_cast<std::size_t>(bundles[n + 1])});
    return all;
}

namespace {

/// Bundles are preferred to single cases only if they save this share of the time: single cases
/// balance the teams better where the estimates are in error.
constexpr double least_gain = 0.02;

/// The cases with the estimated times of a team.
struct TimedCases {
    std::vector<std::size_t> groups;
    std::vector<double> own_s, shared_s;

    double seconds(const Bundle& bundle) const {
        return std::accumulate(
            own_s.begin() + static_cast<std::ptrdiff_t>(bundle.first),
            own_s.begin() + static_cast<std::ptrdiff_t>(bundle.first + bundle.count), 0.0);
    }
};

TimedCases timed(const std::vector<const PlannedCase*>& cases, const TeamLayout& layout,
                 cost::CaseCosts& costs) {
    TimedCases all{.groups = groups_of(cases, costs), .own_s = {}, .shared_s = {}};
    for (const PlannedCase* planned : cases) {
        const cost::CaseTime expected = costs.time(planned->physics, layout.ranks_per_case);
        all.own_s.push_back(expected.own_s);
        all.shared_s.push_back(expected.shared_s);
    }
    return all;
}

/// Groups of at most `longest_s` as one bundle, before the others as single cases in their order.
std::vector<Bundle> with_undivided_groups(const TimedCases& cases, double longest_s) {
    std::vector<Bundle> bundles;
    for (std::size_t first = 0; first < cases.groups.size();) {
        Bundle group{first, 1};
        while (first + group.count < cases.groups.size() &&
               cases.groups[first + group.count] == cases.groups[first])
            ++group.count;
        if (cases.shared_s[first] + cases.seconds(group) <= longest_s)
            bundles.push_back(group);
        else
            for (std::size_t n = 0; n < group.count; ++n)
                bundles.push_back({first + n, 1});
        first += group.count;
    }
    std::ranges::stable_sort(bundles, std::greater<>{},
                             [&](const Bundle& bundle) { return cases.seconds(bundle); });
    return bundles;
}

std::vector<Bundle> single(std::size_t cases) {
    std::vector<Bundle> bundles(cases);
    for (std::size_t n = 0; n < cases; ++n)
        bundles[n].first = n;
    return bundles;
}

double seconds_of(const std::vector<Bundle>& bundles, const TimedCases& cases, int teams) {
    /// The group whose shared data a team has.
    std::vector<std::optional<std::size_t>> stored(static_cast<std::size_t>(teams));
    return end_s(bundles.size(), teams, [&](std::size_t n, std::size_t team) {
        const std::size_t first = bundles[n].first, group = cases.groups[first];
        const bool has_data = std::exchange(stored[team], group) == group;
        return (has_data ? 0.0 : cases.shared_s[first]) + cases.seconds(bundles[n]);
    });
}

} // namespace

std::vector<Bundle> bundles_of(const std::vector<const PlannedCase*>& cases,
                               const TeamLayout& layout, cost::CaseCosts& costs) {
    std::vector<Bundle> best = single(cases.size());
    if (layout.teams <= 1 || cases.empty()) return best;
    const TimedCases times = timed(cases, layout, costs);
    const double single_s = seconds_of(best, times, layout.teams);
    double best_s = (1.0 - least_gain) * single_s;
    for (const double share : {0.125, 0.25, 0.5, 1.0}) {
        std::vector<Bundle> bundles = with_undivided_groups(times, share * single_s);
        const double seconds = seconds_of(bundles, times, layout.teams);
        if (!(seconds < best_s)) continue;
        best_s = seconds;
        best = std::move(bundles);
    }
    return best;
}

void probe(const std::vector<const PlannedCase*>& cases, int ranks_per_case,
           double memory_per_rank_B, cost::CaseCosts& costs, const Comm& world) {
    const auto team_size = [&] {
        return world.broadcast(
            choose_teams(cases, world.size(), ranks_per_case, memory_per_rank_B, costs)
                .ranks_per_case);
    };
    cost::measure_rates(
        costs, cases, team_size, memory_per_rank_B, world,
        {.report = [](const std::string& text) { fmt::print(stderr, "{}\n", text); }});
    cost::measure_files(costs, cases, team_size(), memory_per_rank_B, world);
}

} // namespace shearwake::schedule
