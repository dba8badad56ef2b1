// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "neural/hand/hand.hpp"
#include "parallel/comm.hpp"
#include "problem/case/case.hpp"

#include <string>
#include <vector>

namespace shearwake::pipeline {

/// Memory in bytes that each rank may use: the free memory of the machine, limited by the control
/// group of a batch system or container, divided among the ranks on the machine, and at most the
/// limit of `ulimit -v`. Infinity if unknown. Collective; the minimum over all machines, equal on
/// all ranks.
double memory_per_rank_B(const Comm& world);

/// The peak memory of this rank so far. Not collective.
double peak_memory_B();

/// What a case needs on a team, decided once and handed on.
struct CasePlan {
    std::shared_ptr<const neural::Scene> receptors; // see receptors_of()
    /// Of engine, recorder, receptors and files; written_B is the size of the case file.
    engines::Resources needs;
};
/// Not collective.
CasePlan plan_case(const Case& c, int ranks, const engines::Solver& engine);

/// "memory per rank: 120.0 MB: ", and the arrays with their sizes in MB, the largest first.
std::string memory_text(const engines::Resources& needs);

/// Whether the rate of a part of the work can be measured without writing a case file. Not
/// collective.
bool can_be_probed(const engines::Work& part);
/// The times of the parts of a case that has taken `seconds`: those of the engine, of the
/// receptors, and the rest as that of the files. Not collective.
std::vector<engines::TimedWork> times_of_parts(const CasePlan& plan,
                                               std::vector<engines::TimedWork> of_engine,
                                               double receptors_s, double seconds);

} // namespace shearwake::pipeline
