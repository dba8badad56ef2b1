// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"

#include "base/json.hpp"
#include "base/python_module.hpp"
#include "base/text.hpp"
#include "measures/measure_table.hpp"
#include "parallel/agree.hpp"
#include "problem/load/array_field.hpp"
#include "schedule/run/run.hpp"
#include "storage/case_file/case_file_reader.hpp"
#include "storage/case_file/groups.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <set>
#include <sstream>
#include <unistd.h>

namespace shearwake::app {
namespace {

struct ShowArguments : schedule::JobArguments { // a case file, or a job with a modulation
    std::filesystem::path case_file;
    std::filesystem::path picture; // empty: <job name>.modulation.png in the working directory
    bool json = false, phases = false;
    double rate_Hz = 0.0; // of the samples; 0: as many as a drawing shows
};

std::string text_of(const storage::CaseSummary& summary, const std::string& name) {
    const auto found = summary.texts.find(name);
    return found == summary.texts.end() ? "unknown" : printable(found->second);
}

void print_solver(const storage::CaseSummary& s) {
    const auto number = [&](const std::string& name) {
        const auto found = s.numbers.find(name);
        return found == s.numbers.end() ? 0.0 : found->second;
    };
    std::string indent = "solver:   ";
    const auto line = [&](std::string_view text) {
        fmt::print("{}{}\n", indent, text);
        indent = "          ";
    };
    if (number("solver_steps") > 0.0)
        line(fmt::format("{:.0f} steps, {:.0f} iterations, at most {:.0f} per step",
                         number("solver_steps"), number("solver_iterations"),
                         number("solver_most_iterations")));
    if (const double work_J = number("solver_work_J"); work_J > 0.0)
        line(fmt::format("work of the load: {:.3g} J; share that remains at the end as kinetic "
                         "and strain energy: {:.3g}",
                         work_J, number("solver_energy_J") / work_J));
    if (s.numbers.contains("period_work_J"))
        line(fmt::format(
            "per period: {:.5g} J of work of the load, {:.5g} J absorbed in the layers, "
            "{:.5g} J radiated into the half-space; the balance differs by {:.1e} of "
            "the work",
            number("period_work_J"), number("period_absorbed_J"), number("period_radiated_J"),
            number("period_imbalance")));
    if (!s.texts.contains("solver_notes")) return;
    std::istringstream notes(s.texts.at("solver_notes"));
    for (std::string note; next_line(notes, note);)
        line(note);
}

storage::CaseSummary read_summary(const std::filesystem::path& path) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) {
        std::set<std::filesystem::path> files;
        for (const auto& folder : {path, path / "cases"})
            for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
                if (entry.path().extension() == ".h5") files.insert(entry.path());
        throw UsageError(
            files.empty()
                ? path.string() + " is a folder without case files; run the job first"
                : fmt::format("{} is a folder; give one of its case files, for example {}",
                              path.string(), files.begin()->string()),
            ExitCode::environment);
    }
    try {
        storage::CaseSummary summary = storage::read_case_summary(path);
        std::stable_partition(summary.scalars.begin(), summary.scalars.end(),
                              [](const Variable& scalar) {
                                  return !measures::is_at_instant(scalar.name);
                              }); // as in tables
        return summary;
    } catch (const Error& error) {
        throw UsageError(
            path.extension() == ".toml" && std::filesystem::exists(path, ignored)
                ? fmt::format("{0} is a job file; shearwake show --modulation {0} draws "
                              "its modulation",
                              path.string())
                : path.string() + " is not a complete case file: " + error.what(),
            ExitCode::environment);
    }
}

void print_json(const storage::CaseSummary& s) {
    Json texts = Json::object(), measures = Json::array(), series = Json::array();
    for (const auto& [name, text] : s.texts)
        if (name != "settings") texts[name] = text;
    for (const Variable& v : s.scalars)
        measures.push_back({{"name", v.name},
                            {"value", v.values.at(0)},
                            {"units", v.units},
                            {"meaning", v.long_name},
                            {"note", v.note}});
    for (const Variable& v : s.shapes)
        series.push_back({{"name", v.name},
                          {"dimensions", v.dimensions},
                          {"units", v.units},
                          {"meaning", v.long_name}});
    Json members;
    members["id"] = text_of(s, "case_id");
    members["settings"] =
        Json::parse_or_null(s.texts.contains("settings") ? s.texts.at("settings") : "{}");
    members["is_reference"] = text_of(s, "is_reference") == "yes";
    members["measures"] = measures;
    members["series"] = series;
    members["numbers"] = Json::object();
    for (const auto& [name, number] : s.numbers)
        members["numbers"][name] = number;
    members["texts"] = texts;
    fmt::print("{}", json_document("show", members));
}

void print_text(const storage::CaseSummary& s) {
    fmt::print("case {}{}: {}\n", text_of(s, "case_id"),
               text_of(s, "is_reference") == "yes" ? " (reference)" : "", text_of(s, "title"));
    fmt::print("swept:    {}\n", text_of(s, "settings"));
    if (s.texts.contains("overrides")) fmt::print("override: -S {}\n", text_of(s, "overrides"));
    fmt::print("status:   {}, checksum verified\n", text_of(s, "status"));
    const double wall_s = s.numbers.contains("wall_s") ? s.numbers.at("wall_s") : 0.0;
    const double ranks = s.numbers.contains("ranks") ? s.numbers.at("ranks") : 0.0;
    fmt::print("computed: {} to {} on {}, {}, {:.3g} s\n", text_of(s, "started"),
               text_of(s, "ended"), text_of(s, "host"), counted(std::lround(ranks), "rank"),
               wall_s);
    fmt::print("program:  {}, git {}, {} ({}), {}, {}, HDF5 {}\n", text_of(s, "program"),
               text_of(s, "git_id"), text_of(s, "compiler"), text_of(s, "build_type"),
               text_of(s, "mpi_version"), text_of(s, "fftw_version"), text_of(s, "hdf5_version"));
    print_solver(s);
    if (s.texts.contains("warnings"))
        for (const Remark& w : storage::warnings_in(s.texts.at("warnings")))
            fmt::print("{}: {}: {}\n", w.severity == Severity::error ? "not valid" : "warning",
                       w.key, w.message);
    fmt::print("\nmeasures:\n");
    for (const Variable& v : s.scalars) {
        const double value = v.values.at(0);
        const std::string shown = std::isnan(value) ? "-" : fmt::format("{:.6g}", value);
        fmt::print("  {:<28} {:>12}  {}{}\n", v.name, shown, v.long_name,
                   v.note.empty() ? "" : " [" + v.note + "]");
    }
    fmt::print("\nseries in the root group (dimensions depth, time):\n");
    for (const Variable& v : s.shapes) {
        std::string shape;
        for (const std::string& extent : v.dimensions)
            shape += (shape.empty() ? "" : " x ") + extent;
        fmt::print("  {:<28} {:>12}  {} [{}]\n", v.name, shape, v.long_name, v.units);
    }
    fmt::print("\nthe case, in SI units:\n{}", text_of(s, "case"));
}

/// Position, speed and gain of the focus, sampled from t = 0 on, in SI units.
Json samples(const Load& load, double span_s, double rate_Hz) {
    if (rate_Hz == 0.0) rate_Hz = 4000.0 / span_s; // finer than a printed line for 40 periods
    std::vector<double> t, x, y, speed, strength;
    for (double n = 0.0; n <= std::round(span_s * rate_Hz); ++n) {
        t.push_back(n / rate_Hz);
        x.push_back(focus_m(load, t.back()).x);
        y.push_back(focus_m(load, t.back()).y);
        speed.push_back(norm(velocity(load.modulation.trajectory, t.back())));
        strength.push_back(gain(load.modulation.envelope, t.back()) *
                           level(load.modulation.trajectory, t.back()));
    }
    return {{"t_s", t}, {"x_m", x}, {"y_m", y}, {"speed_m_s", speed}, {"gain", strength}};
}

Json description(const Case& c, const ShowArguments& arguments) {
    const Load& load = c.scene.load;
    const double run_s = std::min(c.time.duration_s(), off_time_s(load.modulation.trajectory)),
                 frequency_Hz = modulation_frequency_Hz(load.modulation).value_or(0.0),
                 period_s = frequency_Hz > 0.0 ? std::min(run_s, 1.0 / frequency_Hz) : run_s,
                 cycle_s = least_period(load, run_s).period_s; // of all parts
    Json members = {{"kind", load.modulation.kind},
                    {"frequency_Hz", frequency_Hz},
                    {"foci_x_m", Json::array()},
                    {"foci_y_m", Json::array()},
                    {"cycle_s", cycle_s},
                    {"run", samples(load, run_s, arguments.rate_Hz)},
                    {"period", samples(load, period_s, arguments.rate_Hz)}};
    for (const Vec2 focus : load.modulation.foci_m) {
        members["foci_x_m"].push_back(focus.x);
        members["foci_y_m"].push_back(focus.y);
    }
    const auto* array = std::get_if<ArrayFootprint>(&load.footprint);
    if (!array) return members;
    members["distance_m"] = array->distance_m;
    const ArrayField field(*array, 0.0);
    const double count = std::round((cycle_s > 0.0 ? cycle_s : run_s) * arguments.rate_Hz);
    for (double n = 0.0; arguments.phases && n < count; ++n) {
        const auto drives =
            field.drives(foci(load.modulation, updated_s(load, n / arguments.rate_Hz)));
        for (const auto& [place, piston] : board_order(*array))
            members["phases_rad"].push_back(std::arg(drives[piston])); // frame by frame
    }
    return members;
}

void draw_modulation(const ShowArguments& arguments, const Comm& world) {
    const config::Job job = schedule::load_job(arguments.job, arguments.overrides, world);
    on_root(world, [&] {
        print_override_warnings(job);
        const Json members = description(job.plan.cases.at(0).physics, arguments);
        if (arguments.json) return fmt::print("{}", json_document("modulation", members));
        std::filesystem::path picture = arguments.picture;
        if (picture.empty()) picture = arguments.job.stem().string() + ".modulation.png";
        const std::filesystem::path data = picture.string() + fmt::format(".{}.json", ::getpid());
        // Removed also after an exception.
        const std::shared_ptr<void> end(nullptr, [&](void*) { std::remove(data.c_str()); });
        std::ofstream(data) << members.dump();
        if (run_python_module("shearwake.report.modulation", {data, picture}) != 0)
            throw UsageError("the picture " + picture.string() +
                                 " was not drawn; --picture sets another folder or format",
                             ExitCode::environment);
        fmt::print("picture: {}\n", picture.string());
    });
}

ExitCode show_command(const ShowArguments& arguments, const Comm& world) {
    if (arguments.case_file.empty()) {
        draw_modulation(arguments, world);
        return ExitCode::done;
    }
    on_root(world, [&] {
        const storage::CaseSummary summary = read_summary(arguments.case_file);
        if (arguments.json)
            print_json(summary);
        else
            print_text(summary);
    });
    return ExitCode::done;
}

} // namespace

void add_show(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<ShowArguments>(
        app, action, "show", "describe one case, or draw a modulation", show_command);
    CLI::App* what = command.add_option_group("what"); // exactly one of the two
    what->add_option("CASE", arguments.case_file, "case file (HDF5)");
    CLI::Option* job =
        what->add_option("--modulation", arguments.job,
                         "draw path, speed and envelope of the first case of this job")
            ->type_name("JOB");
    what->require_option(1);
    add_value(command, "--picture", arguments.picture, "FILE",
              "file for the drawing: .png, .svg or .pdf (default: JOB.modulation.png)")
        ->needs(job);
    add_overrides(command, arguments.overrides, "override a key of the job")->needs(job);
    CLI::Option* json = add_json(command, arguments.json);
    add_value(command, "--rate", arguments.rate_Hz, "HZ",
              "with --modulation and --json: samples of the load per second")
        ->needs(job, json)
        ->check(CLI::Range(1.0, 1e6));
    command.add_flag("--phases", arguments.phases, "with --rate: also the phases of an array")
        ->needs("--rate");
}

} // namespace shearwake::app
