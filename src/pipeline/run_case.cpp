// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/run_case.hpp"

#include "base/error.hpp"
#include "base/units.hpp"
#include "engines/registry/check.hpp"
#include "parallel/agree.hpp"
#include "pipeline/case_content.hpp"
#include "pipeline/compute.hpp"
#include "pipeline/memory.hpp"
#include "storage/case_file/case_file_writer.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>

namespace shearwake::pipeline {
namespace {

/// Checked in advance, since Linux grants more memory than it has and then kills the process.
void refuse_too_large(double needed_B, double available_B) {
    if (needed_B <= available_B) return;
    throw CaseFailure(fmt::format("out of memory: a rank needs {:.1f} GB and may use {:.1f} GB; "
                                  "enlarge domain.spacing_mm, shrink domain.extent_mm, or use "
                                  "more ranks per case or fewer ranks on a machine",
                                  needed_B / 1e9, available_B / 1e9));
}

storage::SurfaceLayout layout_of(const Case& c) {
    storage::SurfaceLayout layout{
        .domain = c.domain, .times_s = {}, .depths_m = c.measure.depths_m};
    for (const std::ptrdiff_t n : recorded_frames(c))
        layout.times_s.push_back(c.time.frame_s(n));
    return layout;
}

/// Whether the case file of an earlier run is resumed. Without it, the checkpoints cannot be used.
/// Collective.
storage::Beginning beginning_of(const std::filesystem::path& path, const Case& c,
                                const storage::SurfaceLayout& layout, const Comm& team,
                                CaseCheckpoints& checkpoints) {
    if (!checkpoints.has_state()) {
        checkpoints.discard(); // the remaining checkpoints cannot be used
        return storage::Beginning::fresh;
    }
    const bool volumes = !c.record.volumes_s.empty();
    if (layout.empty() && !volumes) return storage::Beginning::fresh;
    bool is_usable = false;
    on_root(team, [&] {
        const std::string reason =
            storage::part_error(path, checkpoints.part_record(), layout,
                                volumes ? storage::HasVolume::yes : storage::HasVolume::no);
        is_usable = reason.empty();
        if (!is_usable)
            checkpoints.report(fmt::format("{} {}: the case starts from scratch",
                                           storage::part_path(path).string(), reason));
    });
    if (team.broadcast(is_usable)) return storage::Beginning::resume;
    checkpoints.discard();
    return storage::Beginning::fresh;
}

/// After a temporary failure, such as a full disk, the case can be resumed from the newest
/// checkpoint; after a field that is not finite, it cannot.
std::optional<CaseResults>
compute_with_checkpoints(const PlannedCase& planned, const CasePlan& plan,
                         engines::FrameSource& engine, const Comm& team, const Sinks& sinks,
                         storage::CaseFileWriter& writer, CaseCheckpoints& checkpoints) {
    try {
        std::optional<CaseResults> results = compute(planned, plan, engine, team, sinks);
        if (results) return results;
    } catch (const FieldDiverges&) {
        checkpoints.discard();
        throw;
    } catch (const Error&) {
        if (checkpoints.has_state()) writer.retain_uncommitted();
        throw;
    }
    if (checkpoints.has_state())
        writer.leave_for_later();
    else
        writer.discard();
    return std::nullopt;
}

std::optional<CaseOutcome> compute_and_write(const PlannedCase& planned, const JobFacts& job,
                                             engines::FrameSource& engine, const Comm& team,
                                             const std::filesystem::path& path,
                                             CaseCheckpoints& checkpoints,
                                             const std::function<void()>& tick) {
    const auto began = Clock::now();
    RunFacts facts{.job_title = job.title,
                   .job_text = job.text,
                   .overrides = job.overrides,
                   .ranks = team.size(),
                   .started = storage::timestamp()};
    const Case& c = planned.physics;
    const CasePlan plan = plan_case(c, team.size(), engine);
    refuse_too_large(plan.needs.memory_per_rank_B(), job.memory_per_rank_B);

    const storage::SurfaceLayout layout = layout_of(c);
    const storage::Beginning beginning = beginning_of(path, c, layout, team, checkpoints);
    const bool has_volume = !c.record.volumes_s.empty();
    storage::CaseFileWriter writer(path, team, layout, beginning, checkpoints.part_record(),
                                   has_volume ? storage::HasVolume::yes : storage::HasVolume::no);
    checkpoints.store_with([&writer] { return writer.part_record(); });
    const bool stores_fields = !layout.empty() || has_volume;
    const Sinks sinks{
        .checkpoints = &checkpoints, .writer = stores_fields ? &writer : nullptr, .tick = tick};
    std::optional<CaseResults> computed =
        compute_with_checkpoints(planned, plan, engine, team, sinks, writer, checkpoints);
    if (!computed) return std::nullopt;

    const Comm::Unwatched writing;
    CaseResults& results = *computed;
    std::vector<Remark> discovered;
    if (team.is_root()) {
        facts.columns_in_samples = columns_in_samples(results.groups.front());
        const std::vector<Remark> expected = check(c);
        facts.warnings = case_warnings(c, results, expected);
        std::ranges::copy_if(facts.warnings, std::back_inserter(discovered), [&](const Remark& w) {
            return std::ranges::find(expected, w) == expected.end();
        });
    }
    facts.wall_s = checkpoints.earlier_seconds() + seconds_since(began);
    facts.ended = storage::timestamp();
    facts.solver = std::move(results.solver);
    facts.solver.notes.push_back(memory_text(plan.needs));
    const std::vector<std::string> files = files_read(c);
    facts.solver.notes.insert(facts.solver.notes.end(), files.begin(), files.end());
    facts.solver.notes.insert(facts.solver.notes.end(), results.afferents.begin(),
                              results.afferents.end());
    // The case file is written last: if it exists, all other files do.
    on_root(team, [&] {
        if (c.record.frames) storage::write_xdmf(path, layout);
        if (has_volume) storage::write_volume_xdmf(path, writer.volume());
    });
    const std::vector<Attribute> attributes = case_attributes(planned, facts);
    CaseOutcome outcome{.needs = plan.needs,
                        .is_resumed = checkpoints.earlier_seconds() > 0.0,
                        .checksum = writer.commit(results.groups, attributes)};
    outcome.seconds = checkpoints.earlier_seconds() + seconds_since(began);
    if (team.is_root()) outcome.digest = storage::digest_of(results.groups, attributes);
    outcome.solver = std::move(facts.solver);
    outcome.discovered = std::move(discovered);
    checkpoints.discard();
    return outcome;
}

} // namespace

std::optional<CaseOutcome> run_case(const PlannedCase& planned, const JobFacts& job,
                                    engines::FrameSource& engine, const Comm& team,
                                    const std::filesystem::path& path, CaseCheckpoints& checkpoints,
                                    const std::function<void()>& tick) {
    std::optional<CaseOutcome> outcome;
    fail_together_with_files(team, [&] {
        outcome = compute_and_write(planned, job, engine, team, path, checkpoints, tick);
    });
    return outcome;
}

} // namespace shearwake::pipeline
