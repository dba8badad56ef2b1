// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"
#include "schedule/run/run_arguments.hpp"

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace shearwake::app {

/// Runs the command that the command line names; set by the callback of its subcommand.
using Action = std::function<ExitCode(const Comm&)>;

/// Adds JOB and -S to a command that reads a job.
void add_job(CLI::App* command, schedule::JobArguments& arguments);

/// Adds the option --ranks-per-case, whose default is 0: chosen by the program.
void add_ranks_per_case(CLI::App* command, int& ranks);

/// Adds the option --json to a command that prints a document instead of text.
void add_json(CLI::App* command, bool& json);

/// Accepts these words only, and suggests the nearest one otherwise. The manual page and the
/// completion read them from the description.
CLI::Validator one_of(const std::vector<std::string>& words);

/// Declare the subcommands that read a job: check, keys, schema, plan, run,
/// evaluate, lens. `app` and `action` must
/// outlive the parsing. Not collective.
void add_job_commands(CLI::App& app, Action& action);

/// Declare the subcommands that read results or measure the machine: status, verify, reduce,
/// report, movie, diff, compare, converge, show, respond, bench. `app` and `action` must
/// outlive the parsing. Not collective.
void add_result_commands(CLI::App& app, Action& action);

} // namespace shearwake::app
