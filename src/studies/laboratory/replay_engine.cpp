// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/replay_engine.hpp"

#include "parallel/agree.hpp"
#include "studies/laboratory/converted_data.hpp"

#include <utility>

namespace shearwake::laboratory {

ReplayEngine::ReplayEngine(std::filesystem::path prefix, std::size_t repetition,
                           std::vector<std::string> notes)
    : prefix_(std::move(prefix)), repetition_(repetition), notes_(std::move(notes)) {}

engines::Resources ReplayEngine::resources(const Case& c, int) const {
    return {.arrays = {{"frame", static_cast<double>(c.domain.nx) *
                                     static_cast<double>(c.domain.ny) * sizeof(double)}}};
}

std::vector<Remark> ReplayEngine::limits(const Case& c) const {
    std::vector<Remark> remarks;
    const auto refuse = [&](const char* key, const char* message) {
        remarks.push_back({Severity::error, key, message});
    };
    if (c.study()) refuse("study", "a grid study cannot be compared with a scan");
    if (c.measure.depths_m != std::vector<double>{0.0})
        refuse("measure.depths_mm", "a scan contains the surface only: set it to [0]");
    if (!c.record.volumes_s.empty())
        refuse("record.volumes_ms", "a scan contains the surface only: remove this key");
    if (!stress_depths_m(c).empty())
        refuse("afferents.input", "a scan contains no stress: use \"displacement\"");
    return remarks;
}

void ReplayEngine::run(const Case& c, const Comm& team, engines::Observer& observer,
                       engines::Checkpoints* checkpoints) {
    const std::ptrdiff_t ranks = team.size(), rank = team.rank();
    const std::ptrdiff_t start = c.domain.nx * rank / ranks, end = c.domain.nx * (rank + 1) / ranks;
    const auto plane_size = static_cast<std::size_t>(c.domain.nx * c.domain.ny);
    std::vector<double> plane(plane_size);
    observer.begin({start, end - start});
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
        if (checkpoints && checkpoints->stop_asked()) return;
        const std::size_t frame =
            repetition_ * static_cast<std::size_t>(c.time.frames) + static_cast<std::size_t>(n);
        on_root(team, [&] { read_numbers(prefix_, frame * plane_size, plane); });
        team.broadcast(plane);
        observer.frame({.number = n,
                        .depth = 0,
                        .u_z_m = View2<const double>(plane.data() + start * c.domain.ny,
                                                     end - start, c.domain.ny, c.domain.ny)});
    }
    engines::SolverReport report;
    report.notes = notes_;
    observer.solved(report);
}

} // namespace shearwake::laboratory
