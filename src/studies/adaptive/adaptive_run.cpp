// SPDX-License-Identifier: BSD-3-Clause
#include "studies/adaptive/adaptive_run.hpp"

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "parallel/agree.hpp"
#include "problem/case/plan.hpp"
#include "reduce/derived_tables.hpp"
#include "schedule/run/deadline.hpp"
#include "schedule/run/run.hpp"
#include "schedule/run/output_folder.hpp"
#include "storage/journal/plan_file.hpp"
#include "studies/tables.hpp"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <set>
#include <string>

namespace shearwake::adaptive {
namespace {

using config::AxisPoints;

/// The points of the plan of a folder that lie on the axes of a job. None without a readable plan:
/// the run reports a damaged one.
AxisPoints points_in(const schedule::OutputFolder& folder, const std::vector<AdaptiveAxis>& axes) {
    storage::PlanIndex plan;
    try {
        if (std::filesystem::exists(folder.plan())) plan = storage::read_plan(folder.plan());
    } catch (const UsageError&) {
    }
    AxisPoints points;
    for (const AdaptiveAxis& axis : axes)
        for (const storage::IndexedCase& c : plan.cases)
            for (const Setting& setting : c.settings)
                if (const double* x = std::get_if<double>(&setting.value);
                    x && setting.key == axis.key && *x >= axis.first && *x <= axis.last)
                    points[axis.key].push_back(*x);
    return points;
}

/// Adds points without duplicates, in ascending order.
void add(const AxisPoints& more, AxisPoints& points) {
    for (const auto& [key, values] : more) {
        std::set<double> all(points[key].begin(), points[key].end());
        all.insert(values.begin(), values.end());
        points[key].assign(all.begin(), all.end());
    }
}

/// The points of a plan.
AxisPoints points_of(const Plan& plan) {
    AxisPoints points;
    for (const AdaptiveAxis& axis : plan.adaptive)
        for (const PlannedCase& c : plan.cases)
            for (const Setting& setting : c.settings)
                if (const double* x = std::get_if<double>(&setting.value);
                    x && setting.key == axis.key)
                    points[axis.key].push_back(*x);
    AxisPoints sorted;
    add(points, sorted);
    return sorted;
}

/// What the results of a round ask for: points to add, otherwise what was found. Another run may
/// have begun the next round before; its cases are then computed first.
struct Round {
    bool has_ended = true;
    AxisPoints next;
    std::vector<std::string> sentences;
};

/// Evaluates the results of a plan in a folder, which other runs may extend at any time.
Round evaluated(const schedule::OutputFolder& folder, const Plan& plan) {
    const storage::PlanIndex index = storage::read_plan(folder.plan());
    const reduce::Table table = studies::table_of(folder);
    // Plans only grow: if this is still the plan of the run, both of them belong to it.
    const bool is_extended = storage::read_plan(folder.plan()).cases.size() > plan.cases.size();
    Round round{.has_ended = !is_extended, .next = {}, .sentences = {}};
    if (!round.has_ended) return round;
    for (const reduce::AdaptiveState& state : reduce::adaptive_states(index, table).axes) {
        if (!state.next.empty()) round.next[state.axis.key] = state.next;
        round.sentences.insert(round.sentences.end(), state.sentences.begin(),
                               state.sentences.end());
    }
    return round;
}

AxisPoints shared(const AxisPoints& points, const Comm& world) {
    Json sent = Json::object();
    for (const auto& [key, values] : points)
        sent[key] = values;
    const Json received = Json::parse(world.broadcast(sent.dump()));
    AxisPoints all;
    for (const auto& [key, values] : received.items())
        all[key] = values.get<std::vector<double>>();
    return all;
}

std::string counts_text(const AxisPoints& points) {
    std::string text;
    for (const auto& [key, values] : points)
        text += fmt::format("{}{} of {}", text.empty() ? "" : ", ", counted(values.size(), "point"),
                            key);
    return text;
}

/// A run of rounds in one folder.
class AdaptiveRun {
public:
    AdaptiveRun(const schedule::RunArguments& arguments, config::Job first, const Comm& world)
        : arguments_(arguments), world_(world), deadline_(arguments.walltime, world),
          folder_(schedule::output_folder(arguments.out, first.plan.name)), job_(std::move(first)),
          points_(points_of(job_.plan)), round_(arguments) {
        round_.is_round = arguments_.only.empty();
    }

    ExitCode run() {
        const ExitCode code = run_rounds();
        if (world_.is_root() && arguments_.json) fmt::print("{}", json_document("run", document_));
        return code;
    }

private:
    ExitCode run_rounds() {
        while (true) {
            const ExitCode code = run_round();
            const bool may_continue =
                code == ExitCode::done ||
                (code == ExitCode::some_cases_failed && !arguments_.fail_fast);
            if (!may_continue || !arguments_.only.empty()) return code;
            const Round round = result_of_round();
            if (!round.has_ended) continue;
            if (round.next.empty()) {
                conclude(round);
                return code;
            }
            report(fmt::format("adding {}", counts_text(round.next)));
            add(round.next, points_);
            round_.retry_failed = false; // once per run, not in each round
        }
    }

    /// Prints on rank 0; with --json on the standard error, as the output is a document.
    void report(const std::string& text) const {
        if (world_.is_root() && !arguments_.quiet)
            fmt::print(arguments_.json ? stderr : stdout, "{}\n", text);
    }

    /// Runs the cases of the present points and of those in the folder. Another run may extend the
    /// plan after this one has read it; its points are the same, so the round is repeated.
    ExitCode run_round() {
        while (true) {
            const AxisPoints seen = known();
            add(seen, points_);
            job_ = schedule::load_job(arguments_.job, arguments_.overrides, world_, points_);
            if (!arguments_.walltime.empty())
                round_.walltime =
                    fmt::format("{:.0f}", std::max(1.0, deadline_.limit_s() - elapsed_s()));
            try {
                const ExitCode code = schedule::run_job(job_, round_, world_, &document_);
                if (world_.is_root() && arguments_.json) count_round();
                return code;
            } catch (const UsageError&) {
                if (known() == seen) throw;
            }
        }
    }

    /// Makes the document of the last round one of all rounds. Not collective.
    void count_round() {
        const long before = document_.at("already_complete").get<long>() - computed_ - by_others_;
        document_["already_complete"] = before;
        document_["computed"] = computed_ += document_.at("computed").get<long>();
        document_["by_other_runs"] = by_others_ += document_.at("by_other_runs").get<long>();
    }

    /// The points of the plan in the folder. Collective.
    AxisPoints known() const {
        AxisPoints points;
        on_root(world_, [&] { add(points_in(folder_, job_.plan.adaptive), points); });
        return shared(points, world_);
    }

    /// Collective; the sentences are on rank 0.
    Round result_of_round() const {
        Round round;
        on_root(world_, [&] { round = evaluated(folder_, job_.plan); });
        round.has_ended = world_.broadcast(round.has_ended);
        round.next = shared(round.next, world_);
        return round;
    }

    void conclude(const Round& round) {
        const std::string next = schedule::reduce_command_line(folder_);
        document_["adaptive"] = round.sentences;
        document_["next"] = next;
        if (arguments_.json) return;
        for (const std::string& sentence : round.sentences)
            report(sentence);
        report("next: " + next);
    }

    double elapsed_s() const { return seconds_since(began_); }

    const schedule::RunArguments& arguments_;
    const Comm& world_;
    Clock::time_point began_ = Clock::now();
    schedule::Deadline deadline_;
    schedule::OutputFolder folder_;
    config::Job job_;
    AxisPoints points_;
    schedule::RunArguments round_;
    Json document_;                     // of all rounds, on rank 0
    long computed_ = 0, by_others_ = 0; // cases of all rounds, on rank 0
};

} // namespace

ExitCode adaptive_run(const schedule::RunArguments& arguments, const Comm& world) {
    config::Job job = schedule::load_job(arguments.job, arguments.overrides, world);
    if (job.plan.adaptive.empty()) return schedule::run_job(job, arguments, world);
    return AdaptiveRun(arguments, std::move(job), world).run();
}

} // namespace shearwake::adaptive
