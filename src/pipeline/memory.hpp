// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "neural/hand/hand.hpp"
#include "parallel/comm.hpp"
#include "problem/case/case.hpp"

#include <filesystem>
#include <istream>
#include <string>
#include <vector>

namespace shearwake::pipeline {

/// Memory in bytes that each rank may use: the free memory of the machine, limited by the control
/// group of a batch system or container and by Slurm's variables, divided among the ranks on the
/// machine, and at most the limit of `ulimit -v`. Infinity if unknown. Collective; the minimum over
/// all machines, equal on all ranks.
double memory_per_rank_B(const Comm& world);

/// What the limits of a control group, of version 1 or 2, and of its parents leave in bytes;
/// infinity without a limit. `groups` has the format of /proc/self/cgroup, `root` is the folder in
/// which the groups are mounted. Not collective.
double left_in_group_B(std::istream& groups, const std::filesystem::path& root);

/// Why no run can compute a case of a job: its texts do not fit into case files, or its grid
/// exceeds the memory of any machine. Empty: neither. Not collective.
std::string size_error(const std::string& job_text, const Case& c);

/// The peak memory of this rank so far. Not collective.
double peak_memory_B();

/// What a case needs on a team, decided once and handed on.
struct CasePlan {
    std::shared_ptr<const neural::Scene> receptors; // see receptors_of()
    /// Of engine, recorder, receptors and files; written_B is the size of the case file.
    engines::Resources needs;
};
/// Not collective.
CasePlan plan_case(const Case& c, int ranks, const engines::FrameSource& engine);

/// "memory per rank: 120.0 MB: ", and the arrays with their sizes in MB, the largest first.
std::string memory_text(const engines::Resources& needs);

} // namespace shearwake::pipeline
