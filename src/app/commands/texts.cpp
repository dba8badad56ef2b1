// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "config/keys/key_table.hpp"
#include "measures/measure_table.hpp"

namespace shearwake::app {

void add_keys(CLI::App& app, Action& action) {
    add_text(app, action, "keys", "print the reference of all keys of a job as Markdown",
             config::key_reference);
}

void add_schema(CLI::App& app, Action& action) {
    add_text(app, action, "schema",
             "print the JSON Schema of job files, for completion and checking in editors",
             config::job_schema);
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
