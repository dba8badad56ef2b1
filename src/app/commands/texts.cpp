// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "config/keys/key_table.hpp"
#include "measures/measure_table.hpp"

#include <fmt/format.h>

namespace shearwake::app {

void add_keys(CLI::App& app, Action& action) {
    add_text(app, action, "keys", "print the reference of all keys of a job as Markdown",
             config::key_reference);
}

namespace {

struct SchemaArguments {
    bool is_draft_7 = false;
};

ExitCode print_schema(const SchemaArguments& arguments, const Comm& world) {
    if (world.is_root())
        fmt::print("{}", config::job_schema(arguments.is_draft_7 ? config::Draft::draft_7
                                                                 : config::Draft::draft_2020_12));
    return ExitCode::done;
}

} // namespace

void add_schema(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<SchemaArguments>(
        app, action, "schema",
        "print the JSON Schema of job files, for completion and checking in editors", print_schema);
    command.add_flag("--draft-7", arguments.is_draft_7,
                     "as JSON Schema draft 7, for editors without JSON Schema 2020-12");
}

void add_columns(CLI::App& app, Action& action) {
    add_text(app, action, "columns",
             "print the columns of tables with their units and meanings as Markdown",
             measures::column_reference);
}

void add_presets(CLI::App& app, Action& action) {
    add_text(app, action, "presets",
             "print the values and the sources of the presets of media, bodies and arrays",
             config::preset_reference);
}

} // namespace shearwake::app
