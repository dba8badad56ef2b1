#pragma once

#include "io/case_index.hpp"
#include "io/journal.hpp"
#include "model/plan.hpp"
#include "parallel/comm.hpp"
#include "sweep/commands.hpp"

#include <cstddef>
#include <vector>

namespace shearwake {

/// Which cases a run has to compute.
struct Selection {
    std::vector<std::size_t> work;  // positions in Plan::cases
    std::vector<std::size_t> there; // the same of those that are whole; on rank 0 only
    std::size_t total = 0;
    std::size_t whole = 0;         // their files are there and complete
    std::size_t failed_before = 0; // and are not to be tried again
    std::size_t not_selected = 0;  // by --only or --shard
};

/// Failures that files and disks are to blame for are tried again, those of the case itself only
/// when asked for. Throws UsageError for an unknown id or a shard that is none. Not collective.
Selection select_cases(const Plan& plan, const JournalContents& journal, CaseIndex& index,
                       const RunArguments& arguments);

/// The part of the sweep that a run is told to do, as its journal and lock are named: empty for all
/// of it, "2-of-8" for a shard, "only-<id>" after the first case named. Throws UsageError for a
/// shard that is none. Not collective.
std::string part_name(const RunArguments& arguments);

/// Rank 0's selection on every rank. Collective.
Selection share(const Selection& selection, const Comm& world);

} // namespace shearwake
