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

/// The grid study that a table requests, if it does. Of the other keys of its table, only
/// `effective` ones may be present.
std::shared_ptr<const StudyData> read_study(Reader& options, const StudyLoader& load_study,
                                            std::span<const char* const> effective) {
    if (!options.has("study")) return nullptr;
    for (const std::string& key : options.keys())
        if (std::ranges::find(effective, std::string_view(key)) == effective.end())
            options.error(key, "has no effect with a study; remove it");
    return load_named(options, "study", load_study).value_or(nullptr);
}

/// The table of one engine.
template <class Options>
Solver read_options(Reader reader, const TimeAxis& time, const StudyLoader& load_study) {
    Options options;
    std::shared_ptr<const StudyData> study;
    if constexpr (requires { Options::keys_for_studies; })
        study = read_study(reader, load_study, Options::keys_for_studies);
    read_fields(reader, options);
    if constexpr (requires { options.time_step_s; })
        check_time_step(reader, options.time_step_s, time);
    reader.finish();
    return {options, study};
}

} // namespace

Solver read_solver(Reader& reader, const TimeAxis& time, const StudyLoader& load_study) {
    const auto engine = reader.find_choice("engine", engine_names());
    Solver chosen; // the first engine where none is given
    const std::size_t wanted = [&] {
        const auto names = engine_names();
        const auto found = std::ranges::find(names, engine.value_or(names.front()));
        return static_cast<std::size_t>(found - names.begin());
    }();
    std::size_t number = 0;
    std::string owner; // of the study
    // All tables are read: a sweep over the engine brings them, and their errors are reported.
    for_each_alternative(std::type_identity<SolverOptions>{}, [&](const auto& example) {
        using Options = std::decay_t<decltype(example)>;
        const Solver solver =
            read_options<Options>(reader.optional_table(Options::name), time, load_study);
        if (solver.study) owner = Options::name;
        if (number++ == wanted) chosen = solver;
    });
    if (engine && !owner.empty() && owner != engine_name(chosen.options))
        reader.error("engine",
                     fmt::format("is \"{}\", but only \"{}\" computes the imported simulation of "
                                 "solver.{}.study; to repeat it with \"{}\", describe its medium "
                                 "and its load in a job without this key (docs/how-to/kwave.md)",
                                 engine_name(chosen.options), owner, owner,
                                 engine_name(chosen.options)));
    if (engine || !reader.has("engine"))
        reader.finish(); // otherwise the table of another engine may be present
    return chosen;
}

} // namespace shearwake::config
