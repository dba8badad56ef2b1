#pragma once

#include "model/plan.hpp"
#include "parallel/comm.hpp"
#include "sweep/commands.hpp"
#include "sweep/output_folder.hpp"

#include <cstddef>
#include <vector>

namespace shearwake {

/// Which cases a run has to compute.
struct Selection {
    std::vector<std::size_t> work; // positions in Plan::cases
    std::size_t total = 0;
    std::size_t whole = 0;         // their files are there and complete
    std::size_t failed_before = 0; // and are not to be tried again
    std::size_t not_selected = 0;  // by --only or --shard
};

/// Looks at every case file and at the journal. Throws UsageError for an unknown id or a shard that
/// is none. Not collective.
Selection select_cases(const Plan& plan, const OutputFolder& folder, const RunArguments& arguments);

/// Rank 0's selection on every rank. Collective.
Selection share(const Selection& selection, const Comm& world);

} // namespace shearwake
