#include "sweep/commands.hpp"

#include "base/text.hpp"
#include "sweep/job_source.hpp"
#include "sweep/case_costs.hpp"
#include "sweep/memory.hpp"
#include "sweep/next_command.hpp"
#include "sweep/teams.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace shearwake {
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

/// Grid points across the focus and across the shortest shear wave that the focus can excite, whose
/// wavenumber is where its spectrum has fallen to 1 %.
std::string resolution_of(const Case& c) {
    const double focus = fwhm_m(c.load.footprint) / c.domain.spacing_m;
    const double wave =
        2.0 * std::numbers::pi / bandwidth_rad_m(c.load.footprint, 0.01) / c.domain.spacing_m;
    return fmt::format("{:.1f} / {:.1f}", focus, wave);
}

/// What the engines choose: each distinct line once, with the number of cases it is true of.
void print_choices(const std::vector<const PlannedCase*>& all, const CaseCosts& costs) {
    std::vector<std::pair<std::string, std::size_t>> notes; // in the order of the cases
    std::vector<const PlannedCase*> cases;
    for (const PlannedCase* planned : all)
        if (costs.is_probed(planned->physics)) cases.push_back(planned);
    for (const PlannedCase* planned : cases) {
        const Case& c = planned->physics;
        // Everybody's notes are the same where there is nothing to choose.
        if (std::holds_alternative<LayeredOptions>(c.solver)) continue;
        for (const std::string& note : make_engine(c.solver)->choices(c)) {
            const auto told = std::find_if(notes.begin(), notes.end(),
                                           [&](const auto& n) { return n.first == note; });
            if (told == notes.end())
                notes.emplace_back(note, 1);
            else
                ++told->second;
        }
    }
    if (!notes.empty()) fmt::print("\n");
    for (const auto& [note, count] : notes)
        fmt::print("{}{}\n", note,
                   count == cases.size() ? ""
                                         : fmt::format(" ({} of {} cases)", count, cases.size()));
    if (cases.size() < all.size())
        fmt::print("the other {} cases choose their time steps when they run; their seconds are "
                   "those of the nearest of these {}\n",
                   all.size() - cases.size(), cases.size());
}

/// How the estimate comes about.
void print_layout(const std::vector<const PlannedCase*>& cases, const TeamLayout& layout, int ranks,
                  double memory_B, CaseCosts& costs) {
    double compute_s = 0.0, transposes_s = 0.0, files_s = 0.0, most_s = 0.0;
    const Machine& machine = costs.machine();
    const int busy =
        static_cast<int>(std::min(static_cast<std::size_t>(layout.teams), cases.size()));
    for (const PlannedCase* planned : cases) {
        CaseCost cost = costs.of(planned->physics);
        const double all = seconds_on(cost, layout.ranks_per_case, busy, machine);
        most_s = std::max(most_s, all);
        cost.transposes = 0.0;
        const double without = seconds_on(cost, layout.ranks_per_case, busy, machine);
        const double files = machine.file_s + cost.written_B * busy / machine.written_B_s;
        transposes_s += all - without;
        files_s += files;
        compute_s += without - files;
    }
    const double sum_s = std::max(compute_s + transposes_s + files_s, 1e-300);
    // More teams than cases have nothing to do.
    const int idle = layout.teams > busy ? ranks - busy * layout.ranks_per_case : 0;
    fmt::print("on {} rank{}: {} team{} of {}{}, {:.0f} MB a rank at most, about {:.2g} s\n", ranks,
               ranks == 1 ? "" : "s", busy, busy == 1 ? "" : "s", layout.ranks_per_case,
               idle > 0 ? fmt::format(" ({} ranks have nothing to do)", idle) : "", memory_B / 1e6,
               layout.seconds);
    fmt::print("of a team's time: {:.0f} % computing, {:.0f} % transposing, {:.0f} % files; the "
               "longest case takes {:.2g} s; teams work {:.0f} % of the time\n",
               100.0 * compute_s / sum_s, 100.0 * transposes_s / sum_s, 100.0 * files_s / sum_s,
               most_s, 100.0 * std::min(1.0, layout.busy));
    fmt::print("this machine: {}\n",
               machine.measured.empty()
                   ? "assumed to be a server of 2020; `mpirun shearwake bench machine` measures it"
                   : "measured " + machine.measured);
}

} // namespace

ExitCode plan_command(const PlanArguments& arguments, const Comm& world) {
    const Job job = load_job(arguments.job, arguments.overrides, world);
    // Another number of ranks is meant for another machine.
    const double available_B =
        arguments.ranks > 0 ? std::numeric_limits<double>::infinity() : memory_per_rank_B(world);
    if (!world.is_root()) return ExitCode::done;
    for (const Finding& finding : job.findings)
        fmt::print("{}\n", text(finding));

    const int ranks = arguments.ranks > 0 ? arguments.ranks : world.size();
    std::vector<const PlannedCase*> cases;
    for (const PlannedCase& planned : job.plan.cases)
        cases.push_back(&planned);
    CaseCosts costs(cases, known_machine());
    const TeamLayout layout =
        choose_teams(cases, ranks, arguments.ranks_per_case, available_B, costs);

    fmt::print("{:<16}  {:>11}  {:>6}  {:>14}  {:>8}  {:>7}  settings\n", "id", "grid", "frames",
               "points a focus", "MB/rank", "seconds");
    fmt::print("{:<16}  {:>11}  {:>6}  {:>14}  {:>8}  {:>7}\n", "", "", "", "/ a wave", "", "");
    double memory_B = 0.0;
    for (const PlannedCase& planned : job.plan.cases) {
        const Case& c = planned.physics;
        const double seconds =
            seconds_on(costs.of(c), layout.ranks_per_case, layout.teams, costs.machine());
        const double needed_B = costs.memory_per_rank_B(c, layout.ranks_per_case);
        memory_B = std::max(memory_B, needed_B);
        fmt::print("{:<16}  {:>11}  {:>6}  {:>14}  {:>8.0f}  {:>7.2g}  {}\n", planned.id,
                   fmt::format("{} x {}", c.domain.nx, c.domain.ny), c.time.frames,
                   resolution_of(c), needed_B / 1e6, seconds, settings_of(planned));
    }
    print_choices(cases, costs);
    const Domain& d = job.plan.cases.front().physics.domain;
    fmt::print("\n{} cases; the grid of the first covers {:g} x {:g} mm\n", cases.size(),
               1e3 * d.extent_x_m(), 1e3 * d.extent_y_m());
    print_layout(cases, layout, ranks, memory_B, costs);
    if (memory_B > available_B)
        fmt::print("warning: a rank may use {:.0f} MB: the cases that need more will fail\n",
                   available_B / 1e6);
    fmt::print("next: {}\n", run_command_line(arguments.job, arguments.overrides, {}));
    return ExitCode::done;
}

} // namespace shearwake
