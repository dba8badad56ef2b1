// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_case.hpp"

#include "base/error.hpp"
#include "config/sections/read_fields.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <span>

namespace shearwake::config {
namespace {

void check_time_step(const Reader& options, const std::optional<double>& step_s,
                     const TimeAxis& time) {
    if (step_s && time.frames > 0 && *step_s > time.interval_s * (1.0 + 1e-9))
        options.error("time_step_us",
                      fmt::format("must not exceed time.output_interval_us = {:.6g}, but is {:.6g}",
                                  1e6 * time.interval_s, 1e6 * *step_s));
}

/// The table of one engine.
template <class Options>
Options read_options(Reader reader, const TimeAxis& time) {
    Options options;
    read_fields(reader, options);
    if constexpr (requires { options.time_step_s; })
        check_time_step(reader, options.time_step_s, time);
    reader.finish();
    return options;
}

} // namespace

SolverOptions read_solver(Reader& reader, const TimeAxis& time) {
    const auto engine = reader.find_choice("engine", engine_names());
    SolverOptions chosen; // the first engine where none is given
    const std::size_t wanted = [&] {
        const auto names = engine_names();
        const auto found = std::ranges::find(names, engine.value_or(names.front()));
        return static_cast<std::size_t>(found - names.begin());
    }();
    std::size_t number = 0;
    // All tables are read: a sweep over the engine brings them, and their errors are reported.
    for_each_alternative(std::type_identity<SolverOptions>{}, [&](const auto& example) {
        using Options = std::decay_t<decltype(example)>;
        const Options options = read_options<Options>(reader.optional_table(Options::name), time);
        if (number++ == wanted) chosen = options;
    });
    if (engine || !reader.has("engine"))
        reader.finish(); // otherwise the table of another engine may be present
    return chosen;
}

} // namespace shearwake::config
