// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "problem/case/plan.hpp"
#include "schedule/cost/rates.hpp"

#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::cost {

/// Whether the case has work that is done once per medium and grid.
bool shares_work(const engines::Resources& needs);

/// Seconds of a case on a team: of its own work, and of the work that it shares with other cases.
struct CaseTime {
    double own_s = 0.0, shared_s = 0.0;
    Origin origin = Origin::measured; // the worst of its parts
};

/// Seconds of the work on a team: each part in proportion to the slabs of the fullest rank.
CaseTime time_of(const engines::Resources& needs, int ranks, const Rates& rates);

/// Costs of the cases of a plan. Some engines choose their time step by trial, which may take a
/// tenth of a second. A few cases spread over the plan are probed; every other case is estimated
/// with the time step of the most similar probed case. Not collective.
class CaseCosts {
public:
    /// Called before the time step of a case is chosen: number `number` of `count`, from 1. What it
    /// throws ends the construction.
    using BeforeProbe =
        std::function<void(const PlannedCase& planned, std::size_t number, std::size_t count)>;

    /// Probes until `most_s` seconds of CPU time are used, at least one case. With a limit, ranks
    /// may probe different cases, and a probe of more than a second is given up.
    CaseCosts(const std::vector<const PlannedCase*>& cases, Rates rates,
              const BeforeProbe& before_probe = {},
              double most_s = std::numeric_limits<double>::infinity());

    /// Computes the resources of the largest cases and of others that are spread evenly over the
    /// plan, for `most_s` seconds of CPU time; every other case has those of the one before it.
    /// Returns their number.
    std::size_t limit_resources(const std::vector<const PlannedCase*>& cases, double most_s,
                                int ranks = 1);
    /// Whether the resources of the case are those of another one.
    bool is_of_neighbour(const Case& c) const { return neighbour_.contains(&c); }
    /// The resources of the case, with its receptors and files, on a team of `ranks` ranks.
    const engines::Resources& of(const Case& c, int ranks = 1);
    /// Seconds of the case on a team of `ranks` ranks.
    CaseTime time(const Case& c, int ranks);
    /// Memory per rank of the case on a team of `ranks` ranks, including that of the program
    /// itself.
    double memory_per_rank_B(const Case& c, int ranks) { return of(c, ranks).memory_per_rank_B(); }
    const Rates& rates() const { return rates_; }
    /// Sets the rates on which the times are based.
    void use(Rates rates) { rates_ = std::move(rates); }
    /// Whether the time step of the case is known before it runs.
    bool is_probed(const Case& c) const;
    /// The engine of the case, which remembers the steps that were chosen and what its runs share.
    engines::Engine& engine_of(const Case& c) const;
    void free_engines() { engines_.clear(); }
    /// The case with the time step of the most similar probe, so that its engine need not probe.
    /// Without any probe, the step is the output interval.
    Case with_step(const Case& c) const;

private:
    struct Probe {
        const Case* c;
        double step_s;
    };
    bool is_open(const Case& c) const; // whether its time step must be probed

    Rates rates_;
    std::vector<Probe> probes_;
    // By index of the solver.
    mutable std::map<std::size_t, std::unique_ptr<engines::Engine>> engines_;
    std::map<std::pair<const Case*, int>, engines::Resources> known_; // by case and ranks
    std::map<const Case*, const Case*> neighbour_; // that has the resources of a case
};

/// Hooks of measure_rates().
struct ProbeHooks {
    std::function<void(const std::string&)> report; // prints messages; called on rank 0
    /// Whether to end early; may differ between ranks. Empty: never.
    std::function<bool()> stop = {};
};

/// Measures the rates of those kinds of work of the cases that have not been measured: the engine
/// computes one case of each kind for at most two seconds after its setup, on every team at the
/// same time, since teams share the memory bandwidth. Of many kinds, twelve spread over the plan
/// are measured. Adds the rates to those of `costs` and to the file of this machine. `team_size`,
/// collective, returns the ranks per case that are best with the rates of `costs`; what it returns
/// with the new rates is measured as well. Cases that need more memory than `memory_per_rank_B` are
/// left out, and kinds whose case fails. Collective.
void measure_rates(CaseCosts& costs, const std::vector<const PlannedCase*>& cases,
                   const std::function<int()>& team_size, double memory_per_rank_B,
                   const Comm& world, const ProbeHooks& hooks);

/// Measures the rate of files, if it has not been measured, from the shortest case, if it is short:
/// every team computes it completely into a temporary folder. Not if a team is on several machines.
/// Collective.
void measure_files(CaseCosts& costs, const std::vector<const PlannedCase*>& cases,
                   int ranks_per_case, double memory_per_rank_B, const Comm& world);

} // namespace shearwake::cost

namespace shearwake::schedule {

/// What the cases of a plan need: the largest memory of a rank, and the disk space of all files.
struct Demand {
    double memory_per_rank_B = 0.0;
    double disk_B = 0.0;
};

/// The demand of the cases if all ranks share each case. Time steps are not probed. Of a large
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
