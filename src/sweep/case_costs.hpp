#pragma once

#include "engines/engine.hpp"
#include "model/plan.hpp"
#include "sweep/machine.hpp"

#include <map>
#include <string>
#include <vector>

namespace shearwake {

/// What a case costs, before it is known how many ranks share it.
struct CaseCost {
    double compute_s = 0.0;  // on one rank of this machine
    double shared_s = 0.0;   // once per medium and grid, on one rank
    double transposes = 0.0; // each an all-to-all of the team
    double plane_B = 0.0;    // of all ranks in one of them, mostly a plane of the grid
    double written_B = 0.0;
    int useful_ranks = 1;
};

/// Seconds of a case on a team while `teams` teams write:
///     compute / ranks * (slabs of the fullest rank) + transposes * (ranks * message_s +
///     plane_B / ranks / transposed_B_s) + file_s + written_B * teams / written_B_s
/// Everything is taken to add up. docs/cluster.md argues it.
double seconds_on(const CaseCost& cost, int ranks, int teams, const Machine& machine);
/// Of what is shared between cases, likewise.
double shared_seconds_on(const CaseCost& cost, int ranks, const Machine& machine);

/// Costs of the cases of a plan. The engine `spectral` probes its time step, which takes a tenth of
/// a second: done for a few cases spread over the plan, and taken for those like them. Not
/// collective.
class CaseCosts {
public:
    CaseCosts(const std::vector<const PlannedCase*>& cases, Machine machine);

    const CaseCost& of(const Case& c);
    /// Of the case with a team of so many ranks, all that the program needs included.
    double memory_per_rank_B(const Case& c, int ranks);
    const Machine& machine() const { return machine_; }
    /// The cases whose time step is known beforehand; the others choose theirs when they run.
    bool is_probed(const Case& c) const;

private:
    struct Probe {
        const Case* c;
        double step_s;
    };
    /// The case with a time step that needs no probing.
    Case with_step(const Case& c) const;

    Machine machine_;
    std::vector<Probe> probes_;
    std::map<const Case*, CaseCost> known_;
    std::map<std::pair<const Case*, int>, double> memory_B_;
};

} // namespace shearwake
