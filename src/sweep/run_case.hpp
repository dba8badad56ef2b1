#pragma once

#include "engines/engine.hpp"
#include "model/plan.hpp"
#include "sweep/case_checkpoints.hpp"
#include "sweep/end_alone.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace shearwake {

/// What all cases of a run share: the job, as their files tell it, and the memory of a rank.
struct JobFacts {
    std::string title;
    std::string text;
    std::string overrides; // key=value, one a line
    double memory_per_rank_B = 0.0;
};

/// How it went.
struct CaseOutcome {
    double seconds = 0.0;       // over all runs
    double solve_seconds = 0.0; // of this run, in the engine with its measures and frames
    SolverReport solver;
};

/// What a case needs of the run around it.
struct CaseHooks {
    std::function<void()> tick; // now and then
    EndAlone end_alone;
};

/// Computes one case on a team, from its newest state on if it has one, and writes its file.
/// Returns nothing when it was saved to go on later. Collective over the team. Throws CaseFailure
/// on all its ranks together; nothing half-written is left then but what a state goes with.
std::optional<CaseOutcome> run_case(const PlannedCase& planned, const JobFacts& job, Engine& engine,
                                    const Comm& team, const std::filesystem::path& path,
                                    CaseCheckpoints& checkpoints, const CaseHooks& hooks);

} // namespace shearwake
