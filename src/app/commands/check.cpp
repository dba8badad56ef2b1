// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"

#include "base/json.hpp"
#include "base/text.hpp"
#include "engines/registry/check.hpp"
#include "pipeline/memory.hpp"
#include "schedule/cost/case_costs.hpp"
#include "schedule/run/run.hpp"
#include "studies/optimise/optimise.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace shearwake::app {
namespace {

struct CheckArguments : schedule::JobArguments {
    bool json = false;
    schedule::Target target = schedule::Target::this_machine;
};

/// How the files of all cases were read, each line once.
std::vector<std::string> files_of(const config::Job& job) {
    std::vector<std::string> lines;
    for (const PlannedCase& planned : job.plan.cases)
        for (std::string& line : files_read(planned.physics))
            if (std::ranges::find(lines, line) == lines.end()) lines.push_back(std::move(line));
    return lines;
}

void print_json(const CheckArguments& arguments, const std::optional<config::Job>& job,
                const std::vector<config::Diagnostic>& diagnostics) {
    const auto errors =
        std::count_if(diagnostics.begin(), diagnostics.end(),
                      [](const config::Diagnostic& d) { return d.severity == Severity::error; });
    Json members;
    members["job"] = arguments.job.string();
    members["cases"] = job ? Json(job->plan.cases.size()) : nullptr;
    members["errors"] = errors;
    members["warnings"] = std::ssize(diagnostics) - errors;
    members["diagnostics"] = config::json_of(diagnostics);
    members["files"] = job ? files_of(*job) : std::vector<std::string>();
    fmt::print("{}", json_document("check", members));
}

/// Why `optimise` would reject the job; empty if it would not, or if there is nothing to optimise.
std::string optimise_error(const config::Job& job) {
    try {
        if (job.optimise) optimise::require_optimisable(job.plan, *job.optimise);
    } catch (const UsageError& error) {
        return error.what();
    }
    return {};
}

ExitCode check_command(const CheckArguments& arguments, const Comm& world) {
    std::optional<config::Job> job;
    std::vector<config::Diagnostic> diagnostics;
    try {
        job = schedule::load_job(arguments.job, arguments.overrides, world);
        diagnostics = job->diagnostics;
    } catch (const config::BadJob& bad) {
        if (!arguments.json) throw;
        diagnostics = bad.diagnostics();
    } catch (const UsageError& error) { // the job cannot be read
        if (arguments.json && world.is_root())
            print_json(arguments, {},
                       {{.severity = Severity::error,
                         .file = arguments.job.string(),
                         .message = error.what()}});
        if (!arguments.json) throw;
        return error.code();
    }
    const double memory_B = pipeline::memory_per_rank_B(world);
    if (!world.is_root()) return ExitCode::done;
    const std::size_t of_job = diagnostics.size();
    std::string error = job ? optimise_error(*job) : "";
    if (error.empty() && job && arguments.target == schedule::Target::this_machine)
        error = schedule::excess(schedule::least_demand(cases_of(job->plan), world.size()),
                                 memory_B, std::filesystem::path("out") / job->plan.name,
                                 schedule::run_elsewhere);
    if (!error.empty())
        diagnostics.push_back(
            {.severity = Severity::error, .file = arguments.job.string(), .message = error});
    const bool is_bad = !job || !error.empty();
    if (arguments.json) {
        print_json(arguments, job, diagnostics);
        return is_bad ? ExitCode::bad_job : ExitCode::done;
    }
    for (const std::string& line : files_of(*job))
        fmt::print("{}\n", line);
    if (const std::string line = image_uplift_text(job->plan.cases.front().physics); !line.empty())
        fmt::print("{}\n", line);
    for (std::size_t i = 0; i < of_job; ++i)
        fmt::print("{}\n", coloured(config::text(diagnostics[i]), stdout));
    if (!error.empty()) {
        fmt::print("{}\n", coloured("error: " + error, stdout));
        return ExitCode::bad_job;
    }
    fmt::print("{}: {}, {}, no errors\n", printable(arguments.job.string()),
               counted(job->plan.cases.size(), "case"), counted(of_job, "warning"));
    return ExitCode::done;
}

} // namespace

void add_check(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<CheckArguments>(
        app, action, "check", "report all errors in a job file", check_command);
    add_job(command, arguments);
    add_elsewhere(command, arguments.target);
    add_json(command, arguments.json);
}

} // namespace shearwake::app
