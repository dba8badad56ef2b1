// SPDX-License-Identifier: BSD-3-Clause
#include "parallel/agree.hpp"
#include "studies/optimise/optimise_study.hpp"

#include <algorithm>
#include <set>

namespace shearwake::optimise {
namespace {

constexpr double first_step = 0.5, last_step = 0.05;

/// The search of one case and strength: the best motion so far, and the distance of the motions
/// that the next round tries.
struct MotionSearch {
    std::size_t of = 0;
    double strength = 0.0, step = first_step, eta = 0.0;
    MotionChange best;
    std::vector<MovedCase> tried; // in this round
    std::vector<double> reached;  // eta of each

    bool is_done() const { return step < last_step; }
};

/// eta of the best envelope of each tried motion; each rank computes some. Collective.
void evaluate(const Study& study, std::vector<MotionSearch>& searches, const Comm& world) {
    std::vector<double> reached;
    for (const MotionSearch& search : searches)
        reached.resize(reached.size() + search.tried.size(), 0.0);
    together(world, [&] {
        std::size_t n = 0;
        for (const MotionSearch& search : searches)
            for (const MovedCase& c : search.tried) {
                const std::size_t mine = n++;
                if (mine % static_cast<std::size_t>(world.size()) !=
                    static_cast<std::size_t>(world.rank()))
                    continue;
                reached[mine] =
                    best_for(known_forms(study, c), search.strength, study.options, {}).eta;
            }
    });
    world.sum(reached);
    std::size_t n = 0;
    for (MotionSearch& search : searches) {
        search.reached.assign(reached.begin() + static_cast<std::ptrdiff_t>(n),
                              reached.begin() +
                                  static_cast<std::ptrdiff_t>(n + search.tried.size()));
        n += search.tried.size();
    }
}

/// The motions of a round: first that of the job, then that of the best SM-STM, then those around
/// the best so far.
std::vector<MotionChange> changes_of(const Study& study, const MotionSearch& search, int round,
                                     const BestSm& sm) {
    if (round == 0) return {MotionChange{}};
    if (round > 1) return changes_around(search.best, search.step, study.options);
    const bool swings = std::ranges::find(study.options.over, OptimisedPart::speed_profile) !=
                        study.options.over.end();
    const OptimisedCase& c = study.cases[search.of];
    const auto motion = swings && sm ? motion_of(c.sm[*sm], c.base.physics) : std::nullopt;
    return motion ? std::vector{*motion} : std::vector<MotionChange>{};
}

/// Moves to the best of the tried motions, or halves the step if none around the best is better.
void advance(MotionSearch& search, int round) {
    const auto best = std::ranges::max_element(search.reached);
    if (best != search.reached.end() && *best > search.eta) {
        search.eta = *best;
        search.best = search.tried[static_cast<std::size_t>(best - search.reached.begin())].change;
    } else if (round > 1) {
        search.step *= 0.5;
    }
}

/// Adds the SM-STM around the best ones of a case; returns whether there are new ones.
bool refine_sm(OptimisedCase& c, const std::vector<BestSm>& best, double step,
               const OptimiseOptions& options) {
    const std::size_t before = c.sm.size();
    std::set<std::size_t> centres;
    for (const BestSm& sm : best)
        if (sm) centres.insert(*sm);
    for (const std::size_t centre : centres)
        for (SmCase& next : sm_around(c.plain, c.sm[centre], step, options))
            if (std::ranges::none_of(c.sm, [&](const auto& sm) { return sm.is_same(next); }))
                c.sm.push_back(std::move(next));
    return c.sm.size() > before;
}

} // namespace

ExitCode search_sm(Study& study, const Comm& world) {
    ExitCode code = compute_forms(study, {}, world);
    for (const double step : {1.0, 0.5, 0.25}) {
        if (code != ExitCode::done) return code;
        const auto best = agreed_sm(study, world);
        bool is_refined = false;
        for (std::size_t i = 0; i < study.cases.size(); ++i)
            is_refined |= refine_sm(study.cases[i], best[i], step, study.options);
        if (is_refined) code = compute_forms(study, {}, world);
    }
    return code;
}

ExitCode find_motions(const Study& study, std::vector<std::vector<MotionChange>>& best,
                      const Comm& world) {
    std::vector<MotionSearch> searches;
    for (std::size_t i = 0; i < study.cases.size(); ++i)
        for (const double strength : study.options.strengths)
            searches.push_back({.of = i, .strength = strength});
    const int rounds = study.options.over.size() > 1 ? 1 + study.options.rounds : 0;
    const std::size_t strengths = study.options.strengths.size();
    std::vector<std::vector<BestSm>> sm(study.cases.size(), std::vector<BestSm>(strengths));
    ExitCode code = ExitCode::done;
    for (int round = 0; round <= rounds && code == ExitCode::done; ++round) {
        if (round == 1) sm = agreed_sm(study, world);
        std::vector<MovedCase> all;
        for (std::size_t n = 0; n < searches.size(); ++n) {
            MotionSearch& search = searches[n];
            search.tried.clear();
            if (search.is_done()) continue;
            for (const MotionChange& change :
                 changes_of(study, search, round, sm[search.of][n % strengths]))
                if (auto moved = moved_case(study.cases, search.of, change))
                    search.tried.push_back(std::move(*moved));
            all.insert(all.end(), search.tried.begin(), search.tried.end());
        }
        if (all.empty()) continue;
        code = compute_forms(study, all, world);
        if (code != ExitCode::done || rounds == 0) continue;
        evaluate(study, searches, world);
        for (MotionSearch& search : searches)
            advance(search, round);
    }
    best.assign(study.cases.size(), {});
    for (const MotionSearch& search : searches)
        best[search.of].push_back(search.best);
    return code;
}

} // namespace shearwake::optimise
