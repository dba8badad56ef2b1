#pragma once

#include "engines/engine.hpp"
#include "model/plan.hpp"

#include <filesystem>
#include <functional>
#include <string>

namespace shearwake {

/// What all cases of a run share: the job, as their files tell it, and the memory of a rank.
struct JobFacts {
    std::string title;
    std::string text;
    std::string overrides; // key=value, one a line
    double memory_per_rank_B = 0.0;
};

/// Computes one case on a team and writes its file. Returns the seconds it took. Collective over
/// the team. Throws CaseFailure on all its ranks together; nothing half-written is left then.
double run_case(const PlannedCase& planned, const JobFacts& job, Engine& engine, const Comm& team,
                const std::filesystem::path& path, const std::function<void()>& tick);

} // namespace shearwake
