// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "problem/case/plan.hpp"
#include "schedule/cost/machine.hpp"

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::cost {

/// Cost of a case, independent of the number of ranks that share it.
struct CaseCost {
    double compute_s = 0.0;  // on one rank of this machine
    double shared_s = 0.0;   // once per medium and grid, on one rank
    double serial_s = 0.0;   // repeated on every rank of the team: the choice of the time step
    double transposes = 0.0; // number of transposes; each is an all-to-all of the team
    double plane_B = 0.0;    // that all ranks exchange in one transpose, mostly a plane of the grid
    double written_B = 0.0;  // size of the case file
    int useful_ranks = 1;
    std::string kinds; // of work; estimates of cases with the same kinds have similar errors
};

/// Seconds of a case on a team while `teams` teams write:
///     serial + compute / ranks * (slabs of the fullest rank) + transposes * (ranks * message_s +
///     plane_B / ranks / transposed_B_s) + file_s + written_B * teams / written_B_s
/// All times are added: the model assumes no overlap. docs/how-to/cluster.md gives the reasons.
double seconds_on(const CaseCost& cost, int ranks, int teams, const Machine& machine);
/// Seconds of the work that cases share, on a team.
double shared_seconds_on(const CaseCost& cost, int ranks, const Machine& machine);

/// Costs of the cases of a plan. Some engines choose their time step by trial, which may take a
/// tenth of a second. A few cases spread over the plan are probed; every other case is estimated
/// with the time step of the most similar probed case. Not collective.
class CaseCosts {
public:
    /// Called before the time step of a case is chosen: number `number` of `count`, from 1. What it
    /// throws ends the construction.
    using BeforeProbe =
        std::function<void(const PlannedCase& planned, std::size_t number, std::size_t count)>;

    CaseCosts(const std::vector<const PlannedCase*>& cases, Machine machine,
              const BeforeProbe& before_probe = {});

    const CaseCost& of(const Case& c);
    /// Memory per rank of the case on a team of `ranks` ranks, including that of the program
    /// itself.
    double memory_per_rank_B(const Case& c, int ranks);
    const Machine& machine() const { return machine_; }
    /// The work of the case, including the work that it shares with other cases.
    std::vector<engines::Work> work_of(const Case& c);
    /// The kinds of work of all cases.
    std::set<std::string> kinds();
    /// Sets the machine on which the costs are estimated.
    void use(Machine machine);
    /// Whether the time step of the case is known before it runs.
    bool is_probed(const Case& c) const;

private:
    struct Probe {
        const Case* c;
        double step_s;
        double took_s; // CPU time
    };
    struct Amounts {
        std::vector<engines::Work> work, shared;
        CaseCost cost; // without times of work
    };
    const Amounts& amounts(const Case& c);
    engines::Engine& engine_of(const Case& c) const;
    bool is_open(const Case& c) const; // whether its time step must be probed
    const Probe& nearest_probe(const Case& c) const;
    /// The case with the time step of the most similar probe, so that its engine need not probe.
    Case with_step(const Case& c) const;

    Machine machine_;
    std::vector<Probe> probes_;
    std::vector<const Case*> cases_;
    // By index of the solver.
    mutable std::map<std::size_t, std::unique_ptr<engines::Engine>> engines_;
    std::map<const Case*, Amounts> amounts_;
    std::map<const Case*, CaseCost> known_;
    std::map<std::pair<const Case*, int>, double> memory_B_;
};

} // namespace shearwake::cost

namespace shearwake::schedule {

/// What the cases of a plan need: the largest memory of a rank, and the disk space of all files.
struct Demand {
    double memory_per_rank_B = 0.0;
    double disk_B = 0.0;
};

/// The demand of the cases if all ranks share each case. Time steps are not probed. Of a large
/// plan, only the cases that can be estimated within a second are counted. Not collective.
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
