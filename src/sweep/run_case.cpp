#include "sweep/run_case.hpp"

#include "base/error.hpp"
#include "io/case_file_writer.hpp"
#include "io/journal.hpp"
#include "io/xdmf.hpp"
#include "parallel/agree.hpp"
#include "sweep/afferent_result.hpp"
#include "sweep/case_content.hpp"
#include "sweep/memory.hpp"
#include "sweep/surface_recorder.hpp"

#include <chrono>
#include <fmt/format.h>

namespace shearwake {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point began) {
    return std::chrono::duration<double>(Clock::now() - began).count();
}

/// Asked before it is used: Linux grants memory that it does not have, and then kills.
void refuse_too_large(const Case& c, const Comm& team, double available_B) {
    const double needed_B = memory_needed_B(c, team.size());
    if (needed_B <= available_B) return;
    throw CaseFailure(fmt::format("out of memory: a rank needs {:.1f} GB and may use {:.1f} GB; "
                                  "enlarge domain.spacing_mm, shrink domain.extent_mm, or use "
                                  "more ranks per case or fewer ranks on a machine",
                                  needed_B / 1e9, available_B / 1e9));
}

SurfaceLayout layout_of(const Case& c) {
    SurfaceLayout layout{.domain = c.domain, .times_s = {}, .depths_m = c.measure.depths_m};
    for (const std::ptrdiff_t n : SurfaceRecorder::kept_frames(c))
        layout.times_s.push_back(c.time.frame_s(n));
    return layout;
}

/// Whether the case file of an earlier run is gone on with. Without it the states are worth
/// nothing. Collective.
Beginning beginning_of(const std::filesystem::path& path, const Case& c,
                       const SurfaceLayout& layout, const Comm& team,
                       CaseCheckpoints& checkpoints) {
    if (!checkpoints.has_state()) {
        checkpoints.discard(); // what is left cannot be used
        return Beginning::anew;
    }
    const bool volumes = !c.record.volumes_s.empty();
    if (layout.empty() && !volumes) return Beginning::anew;
    long usable = 0;
    on_root(team, [&] {
        const std::string trouble =
            trouble_with_part(path, layout, volumes ? KeepsVolume::yes : KeepsVolume::no);
        usable = trouble.empty() ? 1 : 0;
        if (usable == 0)
            checkpoints.say(
                fmt::format("{}.part {}: the case begins anew", path.string(), trouble));
    });
    if (team.broadcast(usable) != 0) return Beginning::go_on;
    checkpoints.discard();
    return Beginning::anew;
}

/// Leaves early when a stop was asked for. What fails on the way (a full disk) may go on from the
/// newest state; a field that is not finite may not.
void compute(const Case& c, Engine& engine, const Comm& team, SurfaceRecorder& recorder,
             CaseFileWriter& writer, CaseCheckpoints& checkpoints, const CaseHooks& hooks) {
    try {
        or_end_alone(team, hooks.end_alone, [&] { engine.run(c, team, recorder, &checkpoints); });
    } catch (const FieldDiverges&) {
        checkpoints.discard();
        throw;
    } catch (const Error&) {
        if (checkpoints.has_state()) writer.leave_for_later();
        throw;
    }
    if (checkpoints.stop()) {
        writer.leave_for_later();
        return;
    }
    try {
        or_end_alone(team, hooks.end_alone, [&] { recorder.finish(); });
    } catch (const Error&) {
        checkpoints.discard();
        throw;
    }
}

/// What outlives a rank that ends alone.
struct CaseFiles {
    std::optional<CaseFileWriter> writer;
    std::optional<SurfaceRecorder> recorder;
};

std::optional<CaseOutcome> compute_and_write(const PlannedCase& planned, const JobFacts& job,
                                             Engine& engine, const Comm& team,
                                             const std::filesystem::path& path,
                                             CaseCheckpoints& checkpoints, const CaseHooks& hooks,
                                             CaseFiles& files) {
    const auto began = Clock::now();
    RunFacts facts{.job_title = job.title,
                   .job_text = job.text,
                   .overrides = job.overrides,
                   .ranks = team.size(),
                   .started = timestamp()};
    const Case& c = planned.physics;
    refuse_too_large(c, team, job.memory_per_rank_B);

    const SurfaceLayout layout = layout_of(c);
    CaseFileWriter& writer =
        files.writer.emplace(path, team, layout, beginning_of(path, c, layout, team, checkpoints));
    const bool keeps = !layout.empty() || !c.record.volumes_s.empty();
    SurfaceRecorder& recorder =
        files.recorder.emplace(c, team, keeps ? &writer : nullptr, hooks.tick);
    keep_receptors(c, recorder);
    const double before_solve_s = seconds_since(began);
    compute(c, engine, team, recorder, writer, checkpoints, hooks);
    if (checkpoints.stop()) return std::nullopt;
    const double solve_s = seconds_since(began) - before_solve_s;

    AfferentResult afferents;
    if (c.afferents) afferents = felt(felt_motion(planned, recorder), *c.afferents, team);
    std::vector<VariableGroup> groups;
    on_root(team, [&] {
        groups = case_content(c, recorder.depths(), recorder.traces(), recorder.mach(),
                              recorder.mean_u2());
        add_columns(afferents.columns, groups.front());
        for (VariableGroup& group : afferents.groups)
            groups.push_back(std::move(group));
        if (!recorder.solver().sensors.empty())
            groups.push_back(
                sensor_group(*std::get<PstdOptions>(c.solver).study, recorder.solver().sensors));
    });
    facts.wall_s = checkpoints.earlier_seconds() + seconds_since(began);
    facts.ended = timestamp();
    facts.solver = recorder.solver();
    facts.solver.notes.insert(facts.solver.notes.end(), afferents.notes.begin(),
                              afferents.notes.end());
    // The case file last: where it is there, all else is.
    on_root(team, [&] {
        if (c.record.frames) write_xdmf(path, layout);
        if (!c.record.volumes_s.empty()) write_volume_xdmf(path, writer.volume());
    });
    writer.commit(groups, case_attributes(planned, facts));
    checkpoints.discard();
    return CaseOutcome{facts.wall_s, solve_s, facts.solver};
}

} // namespace

std::optional<CaseOutcome> run_case(const PlannedCase& planned, const JobFacts& job, Engine& engine,
                                    const Comm& team, const std::filesystem::path& path,
                                    CaseCheckpoints& checkpoints, const CaseHooks& hooks) {
    CaseFiles files;
    std::optional<CaseOutcome> outcome;
    or_end_alone(team, hooks.end_alone, [&] {
        outcome = compute_and_write(planned, job, engine, team, path, checkpoints, hooks, files);
    });
    return outcome;
}

} // namespace shearwake
