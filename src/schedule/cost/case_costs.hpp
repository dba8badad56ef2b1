// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "problem/case/plan.hpp"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::cost {

/// Costs of the cases of a plan. Some engines need a tenth of a second to choose their time step.
/// It is chosen for a few cases spread over the plan; every other case is estimated with that of
/// the most similar one. Not collective.
class CaseCosts {
public:
    /// Chooses time steps until `most_s` seconds of CPU time are used, at least one, and gives up a
    /// choice that takes more than a second. Without cases, no step is chosen.
    CaseCosts(const std::vector<const PlannedCase*>& cases, double most_s);

    /// Computes the resources of the largest cases and of others that are spread evenly over the
    /// plan, for `most_s` seconds of CPU time; every other case has those of the one before it.
    /// Returns their number.
    std::size_t limit_resources(const std::vector<const PlannedCase*>& cases, double most_s,
                                int ranks = 1);
    /// Whether the resources of the case are those of another one.
    bool is_of_neighbour(const Case& c) const { return neighbour_.contains(&c); }
    /// The resources of the case, with its receptors and files, on a team of `ranks` ranks.
    const engines::Resources& resources(const Case& c, int ranks = 1);
    /// Whether the time step of the case is known before it runs.
    bool is_step_chosen(const Case& c) const;
    /// The engine of the case, which remembers the steps that were chosen and what its runs share.
    engines::Engine& engine_of(const Case& c) const;
    void free_engines() { engines_.clear(); }
    /// Whether the time step of the case, or of a similar case, is known.
    bool has_step(const Case& c) const { return !is_open(c) || !chosen_.empty(); }
    /// The case with the time step of the most similar case, so that its engine need not choose
    /// one. Without any, the step is the output interval.
    Case with_step(const Case& c) const;

private:
    struct ChosenStep {
        const Case* c;
        double step_s;
    };
    bool is_open(const Case& c) const; // whether its time step must be chosen

    std::vector<ChosenStep> chosen_;
    // By index of the solver.
    mutable std::map<std::size_t, std::unique_ptr<engines::Engine>> engines_;
    std::map<std::pair<const Case*, int>, engines::Resources> known_; // by case and ranks
    std::map<const Case*, const Case*> neighbour_; // that has the resources of a case
};

} // namespace shearwake::cost

namespace shearwake::schedule {

/// What the cases of a plan need: the largest memory of a rank, and the disk space of all files.
struct Demand {
    double memory_per_rank_B = 0.0;
    double disk_B = 0.0;
};

/// The demand of the cases if all ranks share each case. Time steps are not chosen. Of a large
/// plan, some cases spread over it are computed, as many as 0.25 s of CPU time suffice for; others
/// write as much as the one before them. Not collective.
Demand least_demand(const std::vector<const PlannedCase*>& cases, int ranks);

/// What a user can do if another machine runs the job, or who accepts the risk; the end of the
/// message of excess().
inline constexpr std::string_view run_elsewhere = "add --elsewhere if another machine runs the job";
inline constexpr std::string_view run_by_force =
    "add --force to run the job nevertheless (cases that exceed the memory fail)";

/// The error if the demand exceeds the memory per rank or the free space of the disk with `out` (or
/// its nearest existing parent), without "error: "; empty otherwise. Not collective.
std::string excess(const Demand& demand, double memory_per_rank_B, const std::filesystem::path& out,
                   std::string_view remedy);

} // namespace shearwake::schedule
