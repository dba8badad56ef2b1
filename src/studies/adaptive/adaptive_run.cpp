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
#include "schedule/run/select_cases.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/plan_file.hpp"
#include "studies/tables.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <thread>

namespace shearwake::adaptive {
namespace {

/// The state of the other shards of a sweep with adaptive axes. While it exists, a lock in
/// the output folder shows that this shard takes part, also while it computes no case. Without
/// --shard it does nothing. On rank 0; not collective.
class OtherShards {
public:
    /// Throws UsageError if another process runs the same shard.
    OtherShards(schedule::OutputFolder folder, const schedule::RunArguments& arguments,
                const schedule::Deadline& deadline);

    /// How a wait has ended.
    struct Outcome {
        bool is_extended = false; // another shard has extended the plan
        /// Why the shard does not wait any longer: a request to stop, the time limit, or open cases
        /// of shards that are not running; otherwise empty.
        std::string reason;
    };

    /// Waits until all cases of the plan have ended, or another shard has extended the plan.
    Outcome wait(const Plan& plan) const;

    /// Whether the plan in the folder has more cases.
    bool is_extended(const Plan& plan) const;

private:
    std::vector<std::size_t> open_cases(const Plan& plan) const;
    bool is_any_running(const std::string& prefix) const;

    schedule::OutputFolder folder_;
    std::string part_; // empty: not in shards
    const schedule::Deadline& deadline_;
    std::unique_ptr<storage::RunLock> presence_;
};

constexpr auto between_looks = std::chrono::milliseconds(500);
constexpr const char* presence_prefix = "adaptive-";

OtherShards::OtherShards(schedule::OutputFolder folder, const schedule::RunArguments& arguments,
                         const schedule::Deadline& deadline)
    : folder_(std::move(folder)),
      part_(arguments.shard.empty() ? "" : schedule::part_name(arguments)), deadline_(deadline) {
    if (part_.empty()) return;
    storage::make_directory(folder_.run_lock().parent_path());
    presence_ = std::make_unique<storage::RunLock>(folder_.part_lock(presence_prefix + part_),
                                                   storage::RunLock::Sharing::alone);
}

std::vector<std::size_t> OtherShards::open_cases(const Plan& plan) const {
    const storage::JournalContents journal = storage::read_journals(folder_.root);
    storage::CaseIndex index(folder_.root);
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < plan.cases.size(); ++i) {
        const std::string& id = plan.cases[i].id;
        const auto history = journal.cases.find(id);
        const bool failed = history != journal.cases.end() &&
                            history->second.state == storage::CaseHistory::State::failed;
        if (!failed && !index.is_complete(id)) open.push_back(i);
    }
    return open;
}

/// Whether another shard holds its lock `<prefix>K-of-N`.
bool OtherShards::is_any_running(const std::string& prefix) const {
    std::error_code missing;
    for (const auto& entry :
         std::filesystem::directory_iterator(folder_.run_lock().parent_path(), missing)) {
        const std::string name = entry.path().filename().string();
        std::size_t number = 0, of = 0;
        const bool is_part =
            name.starts_with(prefix) &&
            std::sscanf(name.c_str() + prefix.size(), "%zu-of-%zu", &number, &of) == 2;
        if (is_part && name != prefix + part_ && storage::is_locked(entry.path()).value_or(false))
            return true;
    }
    return false;
}

bool OtherShards::is_extended(const Plan& plan) const {
    return storage::read_plan(folder_.plan()).cases.size() > plan.cases.size();
}

OtherShards::Outcome OtherShards::wait(const Plan& plan) const {
    if (part_.empty()) return {};
    while (true) {
        // The locks are read first: a shard may complete its cases and end in between.
        const bool is_any_present = is_any_running(presence_prefix);
        const std::size_t open = open_cases(plan).size();
        if (is_extended(plan)) return {.is_extended = true, .reason = ""};
        // Nobody may compute while the plan is extended.
        if (open == 0 && !is_any_running("")) return {};
        if (open > 0 && !is_any_present)
            return {.is_extended = false,
                    .reason = fmt::format(
                        "{} cases of other shards are not complete; the points of the next round "
                        "follow from them: run the other shards at the same time, or rerun this "
                        "command after them",
                        open)};
        std::error_code none;
        if (schedule::stop_requested() || std::filesystem::exists(folder_.stop_file(), none))
            return {.is_extended = false,
                    .reason = "stopped early, all computed results are saved"};
        if (deadline_.left_s() <= 0.0)
            return {.is_extended = false,
                    .reason = "the time limit is reached, all results are saved"};
        std::this_thread::sleep_for(between_looks);
    }
}

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

/// What the results of a round ask for: points to add, otherwise what was found. Another shard may
/// have begun the next round before; its cases are then computed first.
struct Round {
    bool has_ended = true;
    AxisPoints next;
    std::vector<std::string> sentences;
};

/// Evaluates the results of a plan in a folder, which other shards may extend at any time.
Round evaluated(const schedule::OutputFolder& folder, const Plan& plan, const OtherShards& others) {
    const storage::PlanIndex index = storage::read_plan(folder.plan());
    const reduce::Table table = studies::table_of(folder);
    // Plans only grow: if this is still the plan of the run, both of them belong to it.
    Round round{.has_ended = !others.is_extended(plan), .next = {}, .sentences = {}};
    if (!round.has_ended) return round;
    for (const reduce::AdaptiveState& state : reduce::adaptive_states(index, table).axes) {
        if (!state.next.empty()) round.next[state.axis.key] = state.next;
        round.sentences.insert(round.sentences.end(), state.sentences.begin(),
                               state.sentences.end());
    }
    return round;
}

AxisPoints shared(const AxisPoints& points, const Comm& world) {
    return nlohmann::json::parse(world.broadcast(nlohmann::json(points).dump())).get<AxisPoints>();
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
        on_root(world, [&] { shards_.emplace(folder_, arguments_, deadline_); });
        round_.is_round = arguments_.only.empty();
    }

    ExitCode run() {
        const ExitCode code = all_rounds();
        if (world_.is_root() && arguments_.json) fmt::print("{}", json_document("run", document_));
        return code;
    }

private:
    ExitCode all_rounds() {
        while (true) {
            const ExitCode code = one_round();
            const bool may_continue =
                code == ExitCode::done ||
                (code == ExitCode::some_cases_failed && !arguments_.fail_fast);
            if (!may_continue || !arguments_.only.empty()) return code;
            const OtherShards::Outcome others = others_ended();
            if (!others.reason.empty()) return ExitCode::stopped_early;
            if (others.is_extended) continue;
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

    /// Runs the cases of the present points and of those in the folder. Another shard may extend
    /// the plan between reading and locking it; its points are the same, so the round is repeated.
    ExitCode one_round() {
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
                if (arguments_.shard.empty() || known() == seen) throw;
            }
        }
    }

    /// Makes the document of the last round one of all rounds. Not collective.
    void count_round() {
        const long now = document_.at("computed").get<long>();
        document_["computed"] = computed_ + now;
        document_["already_complete"] = document_.at("already_complete").get<long>() - computed_;
        computed_ += now;
    }

    /// The points of the plan in the folder. Collective.
    AxisPoints known() const {
        AxisPoints points;
        on_root(world_, [&] { add(points_in(folder_, job_.plan.adaptive), points); });
        return shared(points, world_);
    }

    /// Waits for the cases of other shards, and prints why the run ends before. Collective.
    OtherShards::Outcome others_ended() {
        if (arguments_.shard.empty()) return {};
        OtherShards::Outcome outcome;
        on_root(world_, [&] { outcome = shards_->wait(job_.plan); });
        outcome.is_extended = world_.broadcast(outcome.is_extended);
        outcome.reason = world_.broadcast(std::move(outcome.reason));
        if (outcome.reason.empty()) return outcome;
        const std::string next = schedule::run_command_line(arguments_);
        document_["state"] = "stopped";
        document_["next"] = next;
        if (world_.is_root() && !arguments_.json)
            fmt::print("{}\nnext: {}\n", outcome.reason, next);
        else
            report(outcome.reason);
        return outcome;
    }

    /// Collective; the sentences are on rank 0.
    Round result_of_round() const {
        Round round;
        on_root(world_, [&] { round = evaluated(folder_, job_.plan, *shards_); });
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
    std::optional<OtherShards> shards_; // on rank 0
    nlohmann::ordered_json document_;   // of all rounds, on rank 0
    long computed_ = 0;                 // cases of all rounds, on rank 0
};

} // namespace

ExitCode adaptive_run(const schedule::RunArguments& arguments, const Comm& world) {
    config::Job job = schedule::load_job(arguments.job, arguments.overrides, world);
    if (job.plan.adaptive.empty()) return schedule::run_job(job, arguments, world);
    return AdaptiveRun(arguments, std::move(job), world).run();
}

} // namespace shearwake::adaptive
