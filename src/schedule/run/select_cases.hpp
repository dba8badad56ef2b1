// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "problem/case/plan.hpp"
#include "schedule/run/run.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/journal/journal.hpp"

#include <cstddef>
#include <vector>

namespace shearwake::schedule {

/// The cases that a run has to compute. Other ranks than 0 only have what share() broadcasts.
struct Selection {
    std::vector<std::size_t> work;   // positions in Plan::cases
    std::vector<std::size_t> there;  // positions of the complete cases
    std::vector<std::size_t> others; // positions of the cases that are not selected
    std::size_t total = 0;
    std::size_t complete = 0;     // cases with a complete file
    long failed_before = 0;       // that are not retried
    std::size_t not_selected = 0; // by --only
};

/// Cases that failed because of files or disks are retried; cases with errors of their own only
/// with --retry-failed. Throws UsageError for an unknown id. Not collective.
Selection select_cases(const Plan& plan, const storage::JournalContents& journal,
                       storage::CaseIndex& index, const RunArguments& arguments);

/// Broadcasts the work and the failures of rank 0. Collective.
void share(Selection& selection, const Comm& world);

} // namespace shearwake::schedule
