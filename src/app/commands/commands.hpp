// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "app/common/command.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>

// clang-format off
/// The commands in the order of --help. add_NAME() in NAME.cpp declares each of them, in texts.cpp
/// those that only print a text, and in report.cpp also movie and export, which only start Python.
/// All commands are collective over the world; those that only read or draw do their work on rank 0.
#define SHEARWAKE_COMMANDS(command) \
    command(check) \
    command(keys) \
    command(schema) \
    command(presets) \
    command(columns) \
    command(plan) \
    command(run) \
    command(evaluate) \
    command(lens) \
    command(status) \
    command(verify) \
    command(reduce) \
    command(report) \
    command(movie) \
    command(compare) \
    command(converge) \
    command(optimise) \
    command(show) \
    command(respond) \
    command(kwave) \
    command(bench) \
    command(export) \
    command(measure) \
    command(fit) \
    command(serve) \
    command(explore)
// clang-format on

namespace shearwake::app {

#define SHEARWAKE_DECLARE_COMMAND(name) void add_##name(CLI::App& app, Action& action);
SHEARWAKE_COMMANDS(SHEARWAKE_DECLARE_COMMAND)
#undef SHEARWAKE_DECLARE_COMMAND

/// Draws the report of an output folder, as the command `report` does. Collective.
ExitCode draw_report(const std::filesystem::path& folder, const Comm& world);

} // namespace shearwake::app
