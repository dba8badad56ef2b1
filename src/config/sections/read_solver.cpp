// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_case.hpp"

#include "base/error.hpp"
#include "config/sections/read_fields.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace shearwake::config {
namespace {

void check_time_step(const Reader& options, const std::optional<double>& step_s,
                     const TimeAxis& time) {
    if (step_s && time.frames > 0 && *step_s > time.interval_s * (1.0 + 1e-9))
        options.error("time_step_us",
                      fmt::format("must not exceed time.output_interval_us = {:.6g}, but is {:.6g}",
                                  1e6 * time.interval_s, 1e6 * *step_s));
}

/// With a study, the precision is the only other key of the table that has an effect.
SharedStudy read_study(Reader& options, const StudyLoader& load_study) {
    const auto file = options.find_word("study");
    if (!file) return {};
    for (const char* key : {"time_step_us", "c_p_over_c_s", "top", "load", "displacement_um",
                            "depth_mm", "absorbing_points", "absorbing_strength", "edges"})
        if (options.has(key)) options.error(key, "has no effect with a study; remove it");
    if (!load_study) {
        options.error("study", "names a file, but no files can be read in this context");
        return {};
    }
    try {
        return {load_study(*file)};
    } catch (const UsageError& problem) {
        options.error("study", fmt::format("cannot be used: {}", problem.what()));
        return {};
    }
}

/// What must be known before the fields are read. Most engines need nothing.
void prepare(Reader&, const StudyLoader&, auto&) {}

void prepare(Reader& options, const StudyLoader& load_study, PstdOptions& pstd) {
    pstd.study = read_study(options, load_study);
}

/// What follows from several keys.
void settle(Reader&, auto&) {}

void settle(Reader& options, SpectralOptions& spectral) {
    if (spectral.time_step_s && options.has("accuracy"))
        options.error("accuracy",
                      fmt::format("determines the time step, but {} = {:.6g} is also given; remove "
                                  "one of them, or set the latter to \"auto\"",
                                  options.full("time_step_us"), 1e6 * *spectral.time_step_s));
}

void settle(Reader& options, PstdOptions& pstd) {
    static const std::array<std::string, 2> edges = {"periodic", "absorbing"};
    pstd.absorbing_edges = options.find_choice("edges", edges) == "absorbing";
}

/// The table of one engine.
template <class Options>
Options read_options(Reader reader, const TimeAxis& time, const StudyLoader& load_study) {
    Options options;
    prepare(reader, load_study, options);
    read_fields(reader, options);
    if constexpr (requires { options.time_step_s; })
        check_time_step(reader, options.time_step_s, time);
    settle(reader, options);
    reader.finish();
    return options;
}

} // namespace

SolverOptions read_solver(Reader& reader, const TimeAxis& time, const StudyLoader& load_study) {
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
        const auto options =
            read_options<Options>(reader.optional_table(Options::name), time, load_study);
        if (number++ == wanted) chosen = options;
    });
    if (engine || !reader.has("engine"))
        reader.finish(); // otherwise the table of another engine may be present
    return chosen;
}

} // namespace shearwake::config
