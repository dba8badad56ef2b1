// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/machine_limits.hpp"

#include "engines/registry/make_engine.hpp"
#include "pipeline/case_file_size.hpp"
#include "pipeline/memory.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>

namespace shearwake::schedule {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// The existing folder in which `path` is, or will be.
fs::path existing_parent(const fs::path& path) {
    std::error_code unknown;
    fs::path at = fs::absolute(path, unknown);
    while (!fs::exists(at, unknown) && at.has_relative_path())
        at = at.parent_path();
    return at;
}

} // namespace

Demand least_demand(const std::vector<const PlannedCase*>& cases, int ranks) {
    const auto end = std::chrono::steady_clock::now() + 1s;
    Demand demand;
    for (const PlannedCase* planned : cases) {
        const Case& given = planned->physics;
        const auto engine = engines::make_engine(given.solver);
        const Case c =
            engine->probes_step(given) ? engine->with_step(given, given.time.interval_s) : given;
        demand.memory_per_rank_B =
            std::max(demand.memory_per_rank_B, pipeline::memory_needed_B(c, ranks));
        demand.disk_B += pipeline::case_file_B(c, engine->estimate(c, ranks).written_B);
        if (std::chrono::steady_clock::now() > end) break;
    }
    return demand;
}

std::string excess(const Demand& demand, double memory_per_rank_B, const fs::path& out,
                   std::string_view remedy) {
    if (demand.memory_per_rank_B > memory_per_rank_B)
        return fmt::format("the largest case needs {:.0f} MB per rank, and a rank may use "
                           "{:.0f} MB: increase domain.spacing_mm, decrease domain.extent_mm, use "
                           "more ranks, or {}",
                           demand.memory_per_rank_B / 1e6, memory_per_rank_B / 1e6, remedy);
    const fs::path disk = existing_parent(out);
    const double free_B = storage::free_bytes(disk);
    if (demand.disk_B > free_B)
        return fmt::format("the files of the cases need {:.0f} MB, and the disk with {} has "
                           "{:.0f} MB left: record less ([record]), free disk space, or {}",
                           demand.disk_B / 1e6, disk.string(), free_B / 1e6, remedy);
    return "";
}

} // namespace shearwake::schedule
