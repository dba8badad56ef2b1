// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "app/common/command.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>

// clang-format off
/// The commands in the order of --help, with their headings. add_NAME() in NAME.cpp declares each of
/// them, in texts.cpp those that only print a text, and in report.cpp also movie and export, which
/// only start Python. All commands are collective over the world; those that only read or draw do
/// their work on rank 0.
#define SHEARWAKE_COMMANDS(command) \
    command(check, "Study") \
    command(plan, "Study") \
    command(run, "Study") \
    command(status, "Study") \
    command(reduce, "Study") \
    command(report, "Study") \
    command(evaluate, "Study") \
    command(converge, "Study") \
    command(optimise, "Study") \
    command(show, "Look") \
    command(movie, "Look") \
    command(explore, "Look") \
    command(compare, "Compare") \
    command(verify, "Compare") \
    command(measure, "Compare") \
    command(fit, "Compare") \
    command(lens, "Device") \
    command(export, "Device") \
    command(respond, "Device") \
    command(kwave, "Other programs and this machine") \
    command(serve, "Other programs and this machine") \
    command(bench, "Other programs and this machine") \
    command(keys, "Reference") \
    command(presets, "Reference") \
    command(columns, "Reference") \
    command(schema, "Reference")
// clang-format on

namespace shearwake::app {

#define SHEARWAKE_DECLARE_COMMAND(name, heading) void add_##name(CLI::App& app, Action& action);
SHEARWAKE_COMMANDS(SHEARWAKE_DECLARE_COMMAND)
#undef SHEARWAKE_DECLARE_COMMAND

/// Draws the report of an output folder, as the command `report` does. Collective.
ExitCode draw_report(const std::filesystem::path& folder, const Comm& world);

} // namespace shearwake::app
