// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "engines/engine.hpp"
#include "parallel/agree.hpp"
#include "pipeline/case_checkpoints.hpp"
#include "problem/case/plan.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/hdf5/guard.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace shearwake::pipeline {

/// fail_together() for `work` that opens files through MPI. Their owners must be local to `work`.
/// Collective.
template <class Work>
void fail_together_with_files(const Comm& team, const Work& work) {
    try {
        fail_together(team, work);
    } catch (const Error&) { // on all ranks
        h5::close_abandoned(team);
        throw;
    }
}

/// Data that all cases of a run share: the job, as stored in their files, and the memory of a rank.
struct JobFacts {
    std::string title;
    std::string text;
    std::string overrides; // key=value, one a line
    double memory_per_rank_B = 0.0;
};

/// The result of computing a case.
struct CaseOutcome {
    double seconds = 0.0; // over all runs, with the time to write the file
    engines::SolverReport solver;
    engines::Resources needs;
    bool is_resumed = false; // from a checkpoint, so that this run has computed a part of it
    // On the root of the team.
    std::vector<Remark> discovered; // warnings that `check` did not predict
    // Of the case file, on the root of the team.
    std::string checksum; // its last line
    storage::CaseDigest digest;
};

/// Computes one case on a team, from its newest checkpoint if it has one, and writes its file.
/// Returns nothing if it was saved to be resumed later. Collective over the team. Throws
/// CaseFailure or UsageError on all its ranks, even if only one has failed; partial files are
/// removed then, unless a checkpoint requires them. `tick` is called occasionally.
std::optional<CaseOutcome> run_case(const PlannedCase& planned, const JobFacts& job,
                                    engines::FrameSource& engine, const Comm& team,
                                    const std::filesystem::path& path, CaseCheckpoints& checkpoints,
                                    const std::function<void()>& tick);

} // namespace shearwake::pipeline
