// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands.hpp"

#include "base/text.hpp"
#include "cost/calibration.hpp"
#include "cost/case_costs.hpp"
#include "engines/registry/make_engine.hpp"
#include "pipeline/memory.hpp"
#include "schedule/job_source.hpp"
#include "schedule/machine_limits.hpp"
#include "schedule/next_command.hpp"
#include "schedule/teams.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace shearwake::app {
namespace {

std::string settings_of(const PlannedCase& planned) {
    std::string text = planned.is_reference ? "reference" : "";
    for (const Setting& setting : planned.settings) {
        const std::string value = std::visit(
            [](const auto& v) {
                if constexpr (std::is_same_v<std::decay_t<decltype(v)>, double>)
                    return exact(v);
                else
                    return v;
            },
            setting.value);
        text += fmt::format("{}{} = {}", text.empty() ? "" : ", ",
                            setting.key.substr(setting.key.rfind('.') + 1), value);
    }
    return text;
}

/// Grid points per width of the focus, and per shortest shear wavelength that the focus can excite:
/// the wavenumber at which the spectrum of the footprint has fallen to 1 %.
std::string resolution_of(const Case& c) {
    const double focus = fwhm_m(c.scene().load.footprint) / c.domain.spacing_m;
    const double wave = 2.0 * std::numbers::pi / bandwidth_rad_m(c.scene().load.footprint, 0.01) /
                        c.domain.spacing_m;
    return fmt::format("{:.1f} / {:.1f}", focus, wave);
}

/// Prints the choices of the engines: each distinct line once, with the number of cases to which it
/// applies.
void print_choices(const std::vector<const PlannedCase*>& all, const cost::CaseCosts& costs) {
    std::vector<std::pair<std::string, std::size_t>> notes; // in the order of the cases
    std::vector<const PlannedCase*> cases;
    for (const PlannedCase* planned : all)
        if (costs.is_probed(planned->physics)) cases.push_back(planned);
    for (const PlannedCase* planned : cases) {
        const Case& c = planned->physics;
        for (const std::string& note : engines::make_engine(c.solver)->choices(c)) {
            const auto known = std::find_if(notes.begin(), notes.end(),
                                            [&](const auto& n) { return n.first == note; });
            if (known == notes.end())
                notes.emplace_back(note, 1);
            else
                ++known->second;
        }
    }
    if (!notes.empty()) fmt::print("\n");
    for (const auto& [note, count] : notes)
        fmt::print("{}{}\n", note,
                   count == cases.size() ? ""
                                         : fmt::format(" ({} of {} cases)", count, cases.size()));
    if (cases.size() < all.size())
        fmt::print("the time steps of the other {} cases are chosen when they run; their times are "
                   "estimated from the most similar of these {} cases\n",
                   all.size() - cases.size(), cases.size());
}

/// Prints the teams and the parts of the estimated time.
void print_layout(const std::vector<const PlannedCase*>& cases, const schedule::TeamLayout& layout,
                  int ranks, double memory_B, cost::CaseCosts& costs) {
    double compute_s = 0.0, transposes_s = 0.0, files_s = 0.0, most_s = 0.0;
    const cost::Machine& machine = costs.machine();
    const int busy =
        static_cast<int>(std::min(static_cast<std::size_t>(layout.teams), cases.size()));
    for (const PlannedCase* planned : cases) {
        cost::CaseCost cost = costs.of(planned->physics);
        const double all = cost::seconds_on(cost, layout.ranks_per_case, busy, machine);
        most_s = std::max(most_s, all);
        cost.transposes = 0.0;
        const double without = cost::seconds_on(cost, layout.ranks_per_case, busy, machine);
        const double files = machine.file_s + cost.written_B * busy / machine.written_B_s;
        transposes_s += all - without;
        files_s += files;
        compute_s += without - files;
    }
    const double sum_s = std::max(compute_s + transposes_s + files_s, 1e-300);
    // Teams in excess of the cases stay idle.
    const int idle = layout.teams > busy ? ranks - busy * layout.ranks_per_case : 0;
    fmt::print("on {} rank{}: {} team{} of {}{}, at most {:.0f} MB per rank, about {:.2g} s\n",
               ranks, ranks == 1 ? "" : "s", busy, busy == 1 ? "" : "s", layout.ranks_per_case,
               idle > 0 ? fmt::format(" ({} ranks stay idle)", idle) : "", memory_B / 1e6,
               layout.seconds);
    fmt::print("time of a team: {:.0f} % computing, {:.0f} % transposing, {:.0f} % writing files; "
               "longest case: {:.2g} s; teams are busy {:.0f} % of the time\n",
               100.0 * compute_s / sum_s, 100.0 * transposes_s / sum_s, 100.0 * files_s / sum_s,
               most_s, 100.0 * std::min(1.0, layout.busy));
    fmt::print("performance model: {}\n", machine.measured.empty()
                                              ? "not calibrated, assumes a server of 2020"
                                              : "calibrated " + machine.measured);
}

} // namespace

ExitCode plan_command(const PlanArguments& arguments, const Comm& world) {
    const config::Job job = schedule::load_job(arguments.job, arguments.overrides, world);
    // With --ranks the plan may be for another machine, whose memory is unknown.
    const bool elsewhere = arguments.ranks > 0 || arguments.target == schedule::Target::elsewhere;
    const double available_B =
        elsewhere ? std::numeric_limits<double>::infinity() : pipeline::memory_per_rank_B(world);
    const int ranks = arguments.ranks > 0 ? arguments.ranks : world.size();
    std::vector<const PlannedCase*> cases;
    for (const PlannedCase& planned : job.plan.cases)
        cases.push_back(&planned);
    cost::CaseCosts costs(cases, {});
    calibrate_for(costs, ranks, world,
                  [](const std::string& text) { fmt::print(stderr, "{}\n", text); });
    if (!world.is_root()) return ExitCode::done;
    for (const config::Diagnostic& diagnostic : job.diagnostics)
        fmt::print("{}\n", config::text(diagnostic));

    const schedule::TeamLayout layout =
        schedule::choose_teams(cases, ranks, arguments.ranks_per_case, available_B, costs);

    fmt::print("{:<16}  {:>11}  {:>6}  {:>14}  {:>8}  {:>7}  settings\n", "id", "grid", "frames",
               "points per", "MB/rank", "seconds");
    fmt::print("{:<16}  {:>11}  {:>6}  {:>14}  {:>8}  {:>7}\n", "", "", "", "focus / wave", "", "");
    schedule::Demand demand;
    for (const PlannedCase& planned : job.plan.cases) {
        const Case& c = planned.physics;
        const double seconds =
            cost::seconds_on(costs.of(c), layout.ranks_per_case, layout.teams, costs.machine());
        const double needed_B = costs.memory_per_rank_B(c, layout.ranks_per_case);
        demand.memory_per_rank_B = std::max(demand.memory_per_rank_B, needed_B);
        demand.disk_B += costs.of(c).written_B;
        fmt::print("{:<16}  {:>11}  {:>6}  {:>14}  {:>8.0f}  {:>7.2g}  {}\n", planned.id,
                   fmt::format("{} x {}", c.domain.nx, c.domain.ny), c.time.frames,
                   resolution_of(c), needed_B / 1e6, seconds, settings_of(planned));
    }
    print_choices(cases, costs);
    const Domain& d = job.plan.cases.front().physics.domain;
    fmt::print("\n{} cases; the grid of the first covers {:g} x {:g} mm\n", cases.size(),
               1e3 * d.extent_x_m(), 1e3 * d.extent_y_m());
    print_layout(cases, layout, ranks, demand.memory_per_rank_B, costs);
    if (!elsewhere) {
        const std::string error =
            schedule::excess(demand, available_B, std::filesystem::path("out") / job.plan.name);
        if (!error.empty()) {
            fmt::print("{}\n", error);
            return ExitCode::bad_job;
        }
    }
    fmt::print("next: {}\n", schedule::run_command_line(arguments.job, arguments.overrides, {}));
    return ExitCode::done;
}

} // namespace shearwake::app
