// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "base/json.hpp"
#include "base/labels.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "engines/registry/check.hpp"
#include "engines/registry/make_engine.hpp"
#include "parallel/session.hpp"
#include "pipeline/memory.hpp"
#include "schedule/cost/case_costs.hpp"
#include "schedule/cost/rates.hpp"
#include "schedule/run/arrangement.hpp"
#include "schedule/run/run.hpp"
#include "storage/journal/plan_file.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fmt/format.h>
#include <functional>
#include <limits>
#include <map>
#include <optional>

namespace shearwake::app {
namespace {

struct PlanArguments : schedule::JobArguments {
    bool json = false;
    schedule::Target target = schedule::Target::this_machine;
    int ranks = 0;          // 0: the number of ranks of this program
    int ranks_per_case = 0; // 0: choose
    bool all_cases = false; // list every case of a long plan
    bool verbose = false;   // list the arrays of the largest case
};

/// "AM frequency = 100 Hz; AM depth = 0.5".
std::string settings_of(const PlannedCase& planned) {
    std::string text = planned.is_reference ? "reference" : "";
    for (const Setting& setting : planned.settings) {
        const std::string value =
            std::visit([](const auto& v) { return fmt::format("{}", v); }, setting.value);
        const std::string unit = unit_label(setting.key);
        text += fmt::format("{}{} = {}{}{}", text.empty() ? "" : "; ", label_of(setting.key), value,
                            unit.empty() ? "" : " ", unit);
    }
    return text;
}

/// Grid points per width of the focus.
double points_per_focus(const Case& c) {
    return fwhm_m(c.scene.load.footprint) / c.domain.spacing_m;
}

/// Grid points per shear wavelength at which the spectrum of the footprint has fallen to 1 %.
double points_per_wave(const Case& c) {
    return two_pi / bandwidth_rad_m(c.scene.load.footprint, 0.01) / c.domain.spacing_m;
}

/// The estimates of a case on a team of the layout.
struct PlannedCost {
    const PlannedCase* planned;
    double work;
    std::optional<double> seconds = {}; // nothing without a recorded rate of its engine
    double memory_per_rank_B, disk_B;
    bool is_of_neighbour; // resources of another case, which stand for its own
};

/// A choice of an engine, and the number of cases to which it applies.
struct Choice {
    std::string text;
    std::size_t cases;
};

/// The estimates of a plan, for text and JSON.
struct Estimates {
    std::vector<PlannedCost> cases;
    std::vector<Choice> choices;
    std::size_t chosen = 0;    // cases whose time step is known before they run
    std::size_t estimated = 0; // cases whose memory and time are not those of a neighbour
    schedule::TeamLayout layout;
    int ranks = 1;
    int busy = 1;                            // teams that have a case
    std::optional<double> wall_s, longest_s; // nothing if the time of a case is unknown
    double unsaved_s = 0.0; // longest case that saves no checkpoints, at 1 ns per unit if unknown
    schedule::Demand demand;
    std::string arrays; // of the case that needs most memory
    std::string error;  // memory or disk do not suffice; empty: they do

    /// Ranks times wall time, including idle ranks.
    double core_hours() const { return wall_s.value_or(0.0) * ranks / 3600.0; }
};

/// CPU time for time steps, for choices and for resources. At least one case is computed.
constexpr double most_choosing_s = 0.25, most_notes_s = 0.12, most_resources_s = 0.5;

/// The choices of the engines: each distinct line once, in the order of the cases.
void add_choices(const std::vector<const PlannedCase*>& cases, const cost::CaseCosts& costs,
                 Estimates& e) {
    const std::clock_t began = std::clock();
    for (const PlannedCase* planned : cases) {
        const Case& c = planned->physics;
        if (!costs.is_step_chosen(c)) continue;
        const double used_s = static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
        if (e.chosen > 0 && used_s > most_notes_s) return;
        ++e.chosen;
        std::vector<std::string> notes = files_read(c);
        if (e.chosen == 1) notes.push_back(image_uplift_text(c));
        std::erase(notes, "");
        for (std::string& choice : costs.engine_of(c).choices(c))
            notes.push_back(std::move(choice));
        for (const std::string& note : notes) {
            const auto known = std::ranges::find(e.choices, note, &Choice::text);
            if (known == e.choices.end())
                e.choices.push_back({note, 1});
            else
                ++known->cases;
        }
    }
}

/// The time of the first of several cases that share data contains their computation.
void add_estimates(const std::vector<const PlannedCase*>& cases,
                   const std::vector<const PlannedCase*>& in_order_of_work, cost::CaseCosts& costs,
                   Estimates& e) {
    const int ranks = e.layout.ranks_per_case;
    const std::vector<double> all = schedule::work_per_rank(in_order_of_work, ranks, costs);
    std::map<const PlannedCase*, double> work;
    for (std::size_t i = 0; i < all.size(); ++i)
        work[in_order_of_work[i]] = all[i];
    std::map<std::string, std::optional<double>> rates_s; // by engine
    for (const std::string& engine : engine_names())
        rates_s[engine] = cost::recorded_rate_s(engine);
    std::vector<double> known_s;
    for (const PlannedCase* planned : cases) {
        const Case& c = planned->physics;
        PlannedCost cost{.planned = planned,
                         .work = work.at(planned),
                         .memory_per_rank_B = costs.resources(c, ranks).memory_per_rank_B(),
                         .disk_B = costs.resources(c).written_B,
                         .is_of_neighbour = costs.is_of_neighbour(c)};
        if (const auto rate_s = rates_s.at(engine_name(c.solver)); rate_s && costs.has_step(c))
            known_s.push_back(cost.seconds.emplace(*rate_s * cost.work));
        if (!engines::capabilities_of(c).steps_in_time)
            e.unsaved_s = std::max(e.unsaved_s, cost.seconds.value_or(1e-9 * cost.work));
        if (cost.memory_per_rank_B > e.demand.memory_per_rank_B) {
            e.demand.memory_per_rank_B = cost.memory_per_rank_B;
            e.arrays = pipeline::memory_text(costs.resources(c, ranks));
        }
        e.demand.disk_B += cost.disk_B;
        e.cases.push_back(cost);
    }
    if (known_s.size() < cases.size()) return;
    // `run` starts in the same way.
    e.wall_s = schedule::sweep_length(known_s, e.busy) + seconds_since_start();
    e.longest_s = std::ranges::max(known_s);
}

void print_case(const PlannedCost& cost) {
    const Case& c = cost.planned->physics;
    fmt::print(
        "{:<16}  {:>11}  {:>6}  {:>14}  {:>8}  {:>7}  {}\n", cost.planned->id,
        fmt::format("{} x {}", c.domain.nx, c.domain.ny), c.time.frames,
        fmt::format("{:.1f} / {:.1f}", points_per_focus(c), points_per_wave(c)),
        fmt::format("{}{:.0f}", cost.is_of_neighbour ? "~" : "", cost.memory_per_rank_B / 1e6),
        cost.seconds ? fmt::format("{:.2g}", *cost.seconds) : "?", settings_of(*cost.planned));
}

/// All cases of a short plan. Of a long one, the first and the longest, unless all are wanted.
void print_cases(const std::vector<PlannedCost>& cases, bool all) {
    constexpr std::size_t most = 30, first = 15, longest = 5;
    fmt::print("{:<16}  {:>11}  {:>6}  {:>14}  {:>8}  {:>7}  settings\n", "id", "grid", "frames",
               "points per", "MB/rank", "seconds");
    fmt::print("{:<16}  {:>11}  {:>6}  {:>14}  {:>8}  {:>7}\n", "", "", "", "focus / wave", "", "");
    const std::size_t listed = all || cases.size() <= most ? cases.size() : first;
    for (std::size_t i = 0; i < listed; ++i)
        print_case(cases[i]);
    if (listed == cases.size()) return;
    std::vector<PlannedCost> others(cases.begin() + first, cases.end());
    std::ranges::partial_sort(others, others.begin() + longest, std::greater(), &PlannedCost::work);
    fmt::print("{} further cases, of which the longest {} are:\n", others.size(), longest);
    for (std::size_t i = 0; i < longest; ++i)
        print_case(others[i]);
    fmt::print("--all lists every case\n");
}

/// Choices that are not already among the warnings.
void print_choices(const Estimates& e, const std::vector<config::Diagnostic>& warnings) {
    if (!e.choices.empty()) fmt::print("\n");
    for (const auto& [note, count] : e.choices) {
        const auto is_note = [ending = ": " + note](const config::Diagnostic& warning) {
            return warning.message.find(ending) != std::string::npos;
        };
        if (std::ranges::any_of(warnings, is_note)) continue;
        fmt::print("{}{}\n", note,
                   count == e.chosen ? "" : fmt::format(" ({} of {} cases)", count, e.chosen));
    }
    if (e.chosen == 0)
        fmt::print("choosing time steps takes more than a second and is left to `run`; memory is "
                   "estimated with one step per frame\n");
    else if (e.chosen < e.cases.size())
        fmt::print("the time steps of the other {} cases are chosen when they run; their times are "
                   "estimated from the most similar of these {} cases\n",
                   e.cases.size() - e.chosen, e.chosen);
}

/// "2.5 s", or "3 h 20 min".
std::string duration_of(double seconds) {
    return seconds < 60.0 ? fmt::format("{:.2g} s", seconds) : hours_and_minutes(seconds);
}

/// The teams and, at last, the totals.
void print_totals(const Estimates& e) {
    const Domain& d = e.cases.front().planned->physics.domain;
    fmt::print("\nthe grid of the first case covers {:g} x {:g} mm\n", 1e3 * d.extent_x_m(),
               1e3 * d.extent_y_m());
    if (e.longest_s)
        fmt::print("longest case: {:.2g} s\n", *e.longest_s);
    else
        fmt::print("{}\n", cost::unknown_time);
    fmt::print("{} on {} ({} of {}{}): {}at most {:.0f} MB per rank, {:.3g} MB on disk\n",
               counted(e.cases.size(), "case"), counted(e.ranks, "rank"), counted(e.busy, "team"),
               e.layout.ranks_per_case,
               schedule::idle_ranks_text(e.layout, e.ranks, e.cases.size()),
               e.wall_s ? fmt::format("{:.2g} core hours, about {} of wall time, ", e.core_hours(),
                                      duration_of(*e.wall_s))
                        : "",
               e.demand.memory_per_rank_B / 1e6, e.demand.disk_B / 1e6);
    if (e.unsaved_s > 120.0)
        fmt::print(
            "the longest case that saves no checkpoints may take {}; a run with a shorter time "
            "limit cannot complete it\n",
            duration_of(e.unsaved_s));
    if (e.estimated < e.cases.size())
        fmt::print("memory and time are estimated from {} of {} cases, the largest and others that "
                   "are spread evenly; ~: those of the case before\n",
                   e.estimated, e.cases.size());
}

/// States what the estimates cover if results add further points.
void print_adaptive(const Estimates& e, const std::vector<AdaptiveAxis>& axes) {
    double ratio = 1.0;
    for (const AdaptiveAxis& axis : axes) {
        ratio *= static_cast<double>(axis.most) / static_cast<double>(axis.initial);
        std::string likely;
        if (axis.is_extremum()) {
            const double spacing = (axis.last - axis.first) / static_cast<double>(axis.initial - 1);
            const double rounds = std::max(0.0, std::ceil(std::log2(spacing / axis.tolerance)));
            likely = fmt::format(", about {:.0f} for one curve",
                                 static_cast<double>(axis.initial) + 2.0 * rounds);
        }
        fmt::print("adaptive axis {}: {} points in the first round{}, at most {}\n", axis.key,
                   axis.initial, likely, axis.most);
    }
    if (!axes.empty())
        fmt::print(
            "the estimates above cover the first round only; all rounds together take at most "
            "{:.0f} cases{}\n",
            std::ceil(ratio * static_cast<double>(e.cases.size())),
            e.wall_s ? fmt::format(" and {:.2g} core hours", ratio * e.core_hours()) : "");
}

Json json_of(const AdaptiveAxis& axis) {
    return {{"key", axis.key},
            {"goal", name_of(axis.goal)},
            {"column", axis.column},
            {"tolerance", axis.tolerance},
            {"first_points", axis.initial},
            {"most_points", axis.most}};
}

Json json_of(const PlannedCost& cost) {
    const Case& c = cost.planned->physics;
    return {{"id", cost.planned->id},
            {"settings", storage::settings_json(cost.planned->settings)},
            {"is_reference", cost.planned->is_reference},
            {"grid", {c.domain.nx, c.domain.ny}},
            {"spacing_m", c.domain.spacing_m},
            {"frames", c.time.frames},
            {"points_per_focus", points_per_focus(c)},
            {"points_per_wave", points_per_wave(c)},
            {"seconds", cost.seconds ? Json(*cost.seconds) : Json()},
            {"memory_per_rank_B", cost.memory_per_rank_B},
            {"is_of_neighbour", cost.is_of_neighbour},
            {"disk_B", cost.disk_B}};
}

void print_json(const Estimates& e, const PlanArguments& arguments, const config::Job& job,
                const std::string& next) {
    const auto time = [&](double value) { return e.wall_s ? Json(value) : Json(); };
    Json cases = Json::array(), choices = Json::array(), adaptive = Json::array();
    for (const AdaptiveAxis& axis : job.plan.adaptive)
        adaptive.push_back(json_of(axis));
    for (const PlannedCost& cost : e.cases)
        cases.push_back(json_of(cost));
    for (const Choice& choice : e.choices)
        choices.push_back({{"text", choice.text}, {"cases", choice.cases}});
    fmt::print("{}", json_document("plan", {{"job", arguments.job.string()},
                                            {"name", job.plan.name},
                                            {"diagnostics", config::json_of(job.diagnostics)},
                                            {"files", job.files},
                                            {"cases", cases},
                                            {"estimated_cases", e.estimated},
                                            {"choices", choices},
                                            {"adaptive", adaptive},
                                            {"ranks", e.ranks},
                                            {"teams", e.busy},
                                            {"ranks_per_case", e.layout.ranks_per_case},
                                            {"core_hours", time(e.core_hours())},
                                            {"wall_s", time(e.wall_s.value_or(0.0))},
                                            {"longest_case_s", time(e.longest_s.value_or(0.0))},
                                            {"longest_unsaved_s", time(e.unsaved_s)},
                                            {"memory_per_rank_B", e.demand.memory_per_rank_B},
                                            {"disk_B", e.demand.disk_B},
                                            {"error", e.error.empty() ? Json() : Json(e.error)},
                                            {"next", e.error.empty() ? Json(next) : Json()}}));
}

void print_text(const Estimates& e, const PlanArguments& arguments, const config::Job& job,
                const std::string& next) {
    for (const config::Diagnostic& diagnostic : job.diagnostics)
        fmt::print("{}\n", coloured(config::text(diagnostic), stdout));
    print_cases(e.cases, arguments.all_cases);
    print_choices(e, job.diagnostics);
    if (arguments.verbose) fmt::print("largest {}\n", e.arrays);
    print_totals(e);
    print_adaptive(e, job.plan.adaptive);
    if (e.error.empty())
        fmt::print("next: {}\n", next);
    else
        fmt::print("error: {}\n", e.error);
}

ExitCode plan_command(const PlanArguments& arguments, const Comm& world) {
    const config::Job job = schedule::load_job(arguments.job, arguments.overrides, world);
    // With --ranks the plan may be for another machine, whose memory is unknown.
    const bool elsewhere = arguments.ranks > 0 || arguments.target == schedule::Target::elsewhere;
    const double available_B =
        elsewhere ? std::numeric_limits<double>::infinity() : pipeline::memory_per_rank_B(world);
    const int ranks = arguments.ranks > 0 ? arguments.ranks : world.size();
    const std::vector<const PlannedCase*> cases = cases_of(job.plan);
    if (!world.is_root()) return ExitCode::done;
    cost::CaseCosts costs(cases, most_choosing_s);
    Estimates estimates{.ranks = ranks};
    add_choices(cases, costs, estimates); // engines remember the steps of a few cases
    estimates.estimated = costs.limit_resources(cases, most_resources_s);
    std::vector<const PlannedCase*> in_order;
    for (const std::size_t place : schedule::order_of_work(cases, costs))
        in_order.push_back(cases[place]);
    estimates.layout =
        schedule::choose_teams(in_order, ranks, arguments.ranks_per_case, available_B, costs);
    estimates.busy =
        static_cast<int>(std::min(static_cast<std::size_t>(estimates.layout.teams), cases.size()));
    add_estimates(cases, in_order, costs, estimates);
    if (!elsewhere)
        estimates.error =
            schedule::excess(estimates.demand, available_B,
                             std::filesystem::path("out") / job.plan.name, schedule::run_elsewhere);
    const std::string too_many = schedule::excessive_team(arguments.ranks_per_case, ranks);
    if (!too_many.empty()) fmt::print(stderr, "{}\n", coloured("warning: " + too_many, stderr));
    const std::string next =
        schedule::planned_command_line(arguments.job, arguments.overrides, ranks,
                                       too_many.empty() ? arguments.ranks_per_case : ranks);
    if (arguments.json)
        print_json(estimates, arguments, job, next);
    else
        print_text(estimates, arguments, job, next);
    return estimates.error.empty() ? ExitCode::done : ExitCode::bad_job;
}

} // namespace

void add_plan(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<PlanArguments>(
        app, action, "plan", "list the cases with their ids, grids, memory and time", plan_command);
    add_job(command, arguments);
    add_elsewhere(command, arguments.target);
    add_value(command, "-n,--ranks", arguments.ranks, "N",
              "plan for N ranks (default: the number of ranks that run this command)")
        ->check(CLI::Range(1, 1000000));
    add_ranks_per_case(command, arguments.ranks_per_case);
    command.add_flag("-v,--verbose", arguments.verbose,
                     "list the arrays of the case that needs most memory");
    command.add_flag("--all", arguments.all_cases, "list every case, also of a long plan");
    add_json(command, arguments.json);
}

} // namespace shearwake::app
