// SPDX-License-Identifier: BSD-3-Clause
#include "base/units.hpp"
#include "engines/registry/make_engine.hpp"
#include "parallel/agree.hpp"
#include "pipeline/afferent_result.hpp"
#include "pipeline/memory.hpp"
#include "pipeline/run_case.hpp"
#include "pipeline/surface_recorder.hpp"
#include "schedule/cost/case_costs.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <set>

namespace shearwake::cost {
namespace {

using Times = std::vector<engines::TimedWork>;

/// Kinds of cases that are measured before a run.
constexpr std::size_t most_kinds = 12;
/// A probe of steps ends after `enough_s` if it has seen `enough_steps`, and after `most_s`.
constexpr double enough_s = 0.5, most_s = 2.0;
constexpr int enough_steps = 16;
/// A shorter setup is repeated: the first one includes the search for FFTW plans.
constexpr double repeated_setup_s = 0.5;
/// Frames of the first probe of an engine that cannot be stopped, and their growth.
constexpr std::ptrdiff_t first_frames = 8, growth = 4;

/// Ends the run of an engine after some time, without saving anything, and collects its times.
class ProbeClock : public engines::Checkpoints {
public:
    ProbeClock(const Comm& team, double longest_s, int least_steps)
        : team_(team), longest_s_(longest_s), least_steps_(least_steps) {}
    bool due() override {
        ++steps_;
        if (steps_ == 1) first_ = Clock::now();
        const double seconds = seconds_since(first_);
        ends_ = team_.broadcast(
            steps_ > 1 && ((seconds > enough_s && steps_ > least_steps_) || seconds > longest_s_));
        return ends_;
    }
    void save(const std::function<void(StateWriter&)>&) override {}
    bool restore(const std::function<void(const StateReader&)>&) override { return false; }
    bool stop() const override { return ends_; }
    void timed(const engines::TimedWork& part) override { times.push_back(part); }

    Times times;

private:
    const Comm& team_;
    double longest_s_;
    int least_steps_;
    int steps_ = 0;
    bool ends_ = false;
    Clock::time_point first_;
};

/// The case with its only snapshot in the first frame, so that a probe contains it, and with a
/// measurement at the end.
Case as_probe(Case c) {
    if (c.study()) return c;
    c.measure.at_s = std::min(c.measure.at_s, c.time.duration_s());
    c.measure.settled_after_s = 0.0;
    if (!c.record.volumes_s.empty()) c.record.volumes_s = {c.time.frame_s(0)};
    return c;
}

/// What the runs of a probe have in common.
struct Probed {
    std::unique_ptr<engines::Engine> engine;
    std::shared_ptr<const neural::Scene> receptors;
};

void compute(const Probed& probed, const Case& c, const Comm& team, ProbeClock& clock) {
    pipeline::SurfaceRecorder recorder(c, team, nullptr, {});
    pipeline::record_receptors(c, probed.receptors, recorder);
    probed.engine->run(c, team, recorder, &clock);
}

const engines::TimedWork* part_of(const Times& times, const std::string& kind) {
    const auto found =
        std::ranges::find_if(times, [&](const auto& part) { return part.work.kind == kind; });
    return found == times.end() ? nullptr : &*found;
}

/// The times of an engine that can be stopped after any step.
Times times_of_steps(const Case& c, const Probed& probed, const Comm& team) {
    ProbeClock clock(team, most_s, enough_steps), brief(team, 0.0, 1);
    compute(probed, c, team, clock);
    Times times = clock.times;
    if (times.empty() || team.broadcast(times.front().seconds) > repeated_setup_s) return times;
    compute(probed, c, team, brief);
    times.front() = brief.times.front();
    return times;
}

/// The times of an engine that is given fewer frames: as many as it computes in two seconds, or as
/// its case needs to have all parts of the complete one. The second run with the same frames has
/// all FFTW plans, and the data that cases share.
Times times_of_frames(const Case& c, const Probed& probed, const Comm& team) {
    Times times;
    const std::vector<engines::Work> parts = probed.engine->resources(c, team.size()).work;
    const auto is_timed = [&](const engines::Work& part) { return part_of(times, part.kind); };
    const auto began = Clock::now();
    for (std::ptrdiff_t frames = std::min(first_frames, c.time.frames);;
         frames = std::min(frames * growth, c.time.frames)) {
        const Case brief = as_probe(*probed.engine->shortened(c, frames));
        const auto from = Clock::now();
        ProbeClock first(team, most_s, 0), second(team, most_s, 0);
        compute(probed, brief, team, first);
        compute(probed, brief, team, second);
        times = second.times;
        for (const engines::TimedWork& part : first.times)
            if (!part_of(times, part.work.kind)) times.push_back(part);
        const double took_s = seconds_since(from), left_s = most_s - seconds_since(began);
        const bool is_last =
            frames == c.time.frames ||
            ((took_s > enough_s || static_cast<double>(growth) * took_s > left_s) &&
             std::ranges::all_of(parts, is_timed));
        if (team.broadcast(is_last)) return times;
    }
}

/// The rates of the work of a case that was timed, at the sizes of the case.
void add_rates(const engines::Resources& needs, const Times& times, int ranks, Rates& rates) {
    for (const engines::Work& part : needs.work)
        if (const engines::TimedWork* timed = part_of(times, part.kind);
            timed && timed->work.amount() > 0.0)
            rates.add(
                {part.kind, part.size, ranks, timed->seconds * ranks / timed->work.amount(), true});
}

/// The times of a part of the program; none if it fails, as the case may do in the same way.
template <class Measure>
Times times_or_none(const Comm& team, const Measure& measure) {
    Times times;
    try {
        fail_together(team, [&] { times = measure(); });
    } catch (const std::exception&) { // on all ranks of the team
        return {};
    }
    return times;
}

Times times_of_engine(const Case& c, const Probed& probed, const Comm& team) {
    return probed.engine->shortened(c, c.time.frames) ? times_of_frames(c, probed, team)
                                                      : times_of_steps(as_probe(c), probed, team);
}

/// Of each kind of case whose work has a part that was never measured, the first one.
std::vector<const PlannedCase*> cases_to_probe(CaseCosts& costs,
                                               const std::vector<const PlannedCase*>& cases,
                                               int ranks, double memory_per_rank_B) {
    std::vector<const PlannedCase*> all;
    Rates covered = costs.rates();
    for (const PlannedCase* planned : cases) {
        const engines::Resources& needs = costs.of(planned->physics, ranks);
        const auto is_new = [&](const engines::Work& part) {
            return part.amount() > 0.0 && pipeline::can_be_probed(part) &&
                   covered.of(part, ranks).origin >= Origin::similar;
        };
        if (!std::ranges::any_of(needs.work, is_new)) continue;
        if (costs.memory_per_rank_B(planned->physics, ranks) > memory_per_rank_B) continue;
        all.push_back(planned);
        for (const engines::Work& part : needs.work)
            covered.add({part.kind, part.size, ranks, 1.0, true});
    }
    if (all.size() <= most_kinds) return all;
    std::vector<const PlannedCase*> spread;
    for (std::size_t i = 0; i < most_kinds; ++i)
        spread.push_back(all[i * (all.size() - 1) / (most_kinds - 1)]);
    return spread;
}

/// "spectral, layered".
std::string engines_of(const std::vector<const PlannedCase*>& cases) {
    std::set<std::string> names;
    for (const PlannedCase* planned : cases)
        names.insert(engine_name(planned->physics.solver));
    return fmt::format("{}", fmt::join(names, ", "));
}

Comm team_of(const Comm& world, int ranks_per_case) {
    const int teams = std::max(1, world.size() / ranks_per_case);
    return world.split(std::min(world.rank() / ranks_per_case, teams - 1));
}

/// Adds the rates of rank 0 to those of `costs` and to the file of this machine. Collective.
void adopt(Rates fresh, CaseCosts& costs, const Comm& world) {
    fresh = rates_of_root(fresh, world);
    Rates all = costs.rates();
    for (const Rate& rate : fresh.all())
        all.add(rate);
    costs.use(std::move(all));
    const auto file = rates_file(world.size());
    if (world.is_root() && file && !fresh.all().empty()) save_rates(fresh, *file);
}

/// Measures teams of one size. Returns whether anything was measured. Collective.
bool measure_teams(CaseCosts& costs, const std::vector<const PlannedCase*>& cases,
                   int ranks_per_case, double memory_per_rank_B, const Comm& world,
                   const ProbeHooks& hooks) {
    std::vector<long> chosen; // rank 0 decides
    on_root(world, [&] {
        for (const PlannedCase* planned :
             cases_to_probe(costs, cases, ranks_per_case, memory_per_rank_B))
            chosen.push_back(std::ranges::find(cases, planned) - cases.begin());
    });
    world.broadcast(chosen);
    if (chosen.empty()) return false;
    std::vector<const PlannedCase*> probed;
    for (const long place : chosen)
        probed.push_back(cases[static_cast<std::size_t>(place)]);
    if (world.is_root())
        hooks.report(
            fmt::format("measuring the speed of {} kind{} of case ({}), for at most {:g} s "
                        "each after its setup, once per machine",
                        probed.size(), probed.size() == 1 ? "" : "s", engines_of(probed), most_s));
    const Comm team = team_of(world, ranks_per_case);
    Rates fresh;
    for (const PlannedCase* planned : probed) {
        if (world.any(hooks.stop && hooks.stop())) break;
        const Case c = costs.with_step(planned->physics);
        const engines::Resources& needs = costs.of(planned->physics, ranks_per_case);
        const Probed setting{engines::make_engine(c.solver), pipeline::receptors_of(c)};
        add_rates(needs, times_or_none(team, [&] { return times_of_engine(c, setting, team); }),
                  ranks_per_case, fresh);
        add_rates(needs,
                  times_or_none(team,
                                [&] {
                                    return pipeline::timed_receptors(c, setting.receptors, enough_s,
                                                                     team);
                                }),
                  ranks_per_case, fresh);
    }
    adopt(std::move(fresh), costs, world);
    return true;
}

/// The time of the files of a case that is computed completely, into a folder of this machine.
Times times_of_files(const PlannedCase& planned, double memory_per_rank_B,
                     const std::filesystem::path& folder, const Comm& team) {
    const auto engine = engines::make_engine(planned.physics.solver);
    const storage::Journal journal(folder / "journal.jsonl");
    std::optional<pipeline::CaseOutcome> outcome;
    for (int time = 0; time < 2; ++time) { // the second time, libraries are loaded
        pipeline::CaseCheckpoints checkpoints(
            folder / "case", {}, {}, team, journal,
            {.stop_asked = [] { return false; }, .report = [](const std::string&) {}});
        outcome = pipeline::run_case(planned, {.memory_per_rank_B = memory_per_rank_B}, *engine,
                                     team, folder / "case.h5", checkpoints, {});
    }
    return {outcome->times.back()};
}

/// A new folder; empty if the ranks of a team are on several machines, or if it cannot be created.
std::filesystem::path temporary_folder(const Comm& team) {
    std::error_code none;
    std::string name = (std::filesystem::temp_directory_path(none) / "shearwake-XXXXXX").string();
    const bool is_shared = team.split_by_machine().size() == team.size();
    const bool is_made = team.is_root() && is_shared && ::mkdtemp(name.data());
    return team.broadcast(is_made ? name : "");
}

} // namespace

void measure_rates(CaseCosts& costs, const std::vector<const PlannedCase*>& cases,
                   const std::function<int()>& team_size, double memory_per_rank_B,
                   const Comm& world, const ProbeHooks& hooks) {
    int size = team_size();
    for (int before = 0; size != before;) {
        before = size;
        if (measure_teams(costs, cases, size, memory_per_rank_B, world, hooks)) size = team_size();
    }
}

void measure_files(CaseCosts& costs, const std::vector<const PlannedCase*>& cases,
                   int ranks_per_case, double memory_per_rank_B, const Comm& world) {
    long chosen = -1;
    on_root(world, [&] {
        const auto seconds = [&](const PlannedCase* planned) {
            const CaseTime time = costs.time(planned->physics, ranks_per_case);
            return time.origin == Origin::unknown ? most_s : time.own_s + time.shared_s;
        };
        const auto shortest = std::ranges::min_element(cases, {}, seconds);
        const engines::Work& files = costs.of((*shortest)->physics).work.back();
        if (seconds(*shortest) < enough_s &&
            costs.rates().of(files, ranks_per_case).origin >= Origin::similar)
            chosen = shortest - cases.begin();
    });
    chosen = world.broadcast(chosen);
    if (chosen < 0) return;
    const Comm team = team_of(world, ranks_per_case);
    Rates fresh;
    const std::filesystem::path folder = temporary_folder(team);
    if (!folder.empty())
        for (const engines::TimedWork& files : times_or_none(team, [&] {
                 return times_of_files(*cases[static_cast<std::size_t>(chosen)], memory_per_rank_B,
                                       folder, team);
             }))
            fresh.add(files, ranks_per_case, true);
    std::error_code none;
    if (team.is_root()) std::filesystem::remove_all(folder, none);
    adopt(std::move(fresh), costs, world);
}

} // namespace shearwake::cost
