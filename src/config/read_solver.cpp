#include "config/read_case.hpp"

#include "base/error.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>

namespace shearwake {
namespace {

bool is_auto(Reader& options, std::string_view key) {
    const NodePtr node = options.node(key);
    const auto* word = node ? std::get_if<std::string>(&node->value) : nullptr;
    return word && *word == "auto";
}

std::optional<double> read_time_step_s(Reader& options, const TimeAxis& time) {
    const auto step_s = options.find_number("time_step_us", Range::at_least(0.01));
    if (step_s && time.frames > 0 && *step_s > time.interval_s * (1.0 + 1e-9))
        options.error("time_step_us",
                      fmt::format("must not exceed time.output_interval_us = {:.6g}, and is {:.6g}",
                                  1e6 * time.interval_s, 1e6 * *step_s));
    return step_s;
}

SpectralOptions read_spectral(Reader options, const TimeAxis& time) {
    SpectralOptions spectral;
    if (!is_auto(options, "time_step_us")) spectral.time_step_s = read_time_step_s(options, time);
    spectral.accuracy = options.number_or("accuracy", spectral.accuracy, Range::between(1e-4, 0.1));
    if (spectral.time_step_s && options.has("accuracy"))
        options.error("accuracy",
                      fmt::format("chooses the time step, and {} = {:.6g} gives it; "
                                  "leave one of them out, or set the latter to \"auto\"",
                                  options.full("time_step_us"), 1e6 * *spectral.time_step_s));
    const double degree = options.number_or("degree", spectral.degree, Range::between(2, 16));
    if (degree != std::floor(degree)) options.error("degree", "must be a whole number");
    spectral.degree = static_cast<int>(degree);
    spectral.longest_element_m = options.number_or("longest_element_mm", 0.0, Range::above(0.0));
    spectral.absorbing_depth_m = options.number_or("absorbing_depth_mm", 0.0, Range::above(0.0));
    static const std::array<std::string, 3> methods = {"auto", "one-solve", "iterative"};
    const std::string method = options.find_choice("method", methods).value_or("auto");
    spectral.method = method == "auto"        ? SpectralMethod::automatic
                      : method == "one-solve" ? SpectralMethod::one_solve
                                              : SpectralMethod::iterative;
    spectral.residual =
        options.number_or("residual", spectral.residual, Range::between(1e-13, 1e-2));
    spectral.contrast_cap =
        options.number_or("contrast_cap", spectral.contrast_cap, Range::between(1.0, 1e6));
    options.finish();
    return spectral;
}

LayeredOptions read_layered(Reader options, const TimeAxis& time) {
    LayeredOptions layered;
    layered.time_step_s = read_time_step_s(options, time);
    layered.window_factor =
        options.number_or("window_factor", layered.window_factor, Range::between(1.25, 16.0));
    layered.wrap_suppression =
        options.number_or("wrap_suppression", layered.wrap_suppression, Range::between(10, 1e8));
    layered.interpolation_tolerance = options.number_or(
        "interpolation_tolerance", layered.interpolation_tolerance, Range::between(1e-12, 1e-3));
    options.finish();
    return layered;
}

/// With a study all else of the table but the precision would do nothing.
SharedStudy read_study(Reader& options, const StudyLoader& load_study) {
    const auto file = options.find_word("study");
    if (!file) return {};
    for (const char* key : {"time_step_us", "c_p_over_c_s", "top", "load", "displacement_um",
                            "depth_mm", "absorbing_points", "absorbing_strength", "edges"})
        if (options.has(key)) options.error(key, "does nothing beside a study: leave it out");
    if (!load_study) {
        options.error("study", "names a file, and no files are read here");
        return {};
    }
    try {
        return {load_study(*file)};
    } catch (const UsageError& problem) {
        options.error("study", fmt::format("cannot be used: {}", problem.what()));
        return {};
    }
}

PstdOptions read_pstd(Reader options, const TimeAxis& time, const StudyLoader& load_study) {
    PstdOptions pstd;
    pstd.study = read_study(options, load_study);
    if (!is_auto(options, "time_step_us")) pstd.time_step_s = read_time_step_s(options, time);
    pstd.c_p_over_c_s =
        options.number_or("c_p_over_c_s", pstd.c_p_over_c_s, Range::between(2.0, 1000.0));
    static const std::array<std::string, 3> tops = {"void", "continued", "fluid"};
    const std::string top = options.find_choice("top", tops).value_or("void");
    pstd.top = top == "void"        ? PstdTop::nothing
               : top == "continued" ? PstdTop::continued
                                    : PstdTop::fluid;
    for (const char* key : {"fluid_density_kg_m3", "fluid_c_p_m_s"})
        if (options.has(key) && pstd.top != PstdTop::fluid)
            options.error(key, fmt::format("is of {} = \"fluid\", which is \"{}\"",
                                           options.full("top"), top));
    pstd.fluid_density_kg_m3 =
        options.number_or("fluid_density_kg_m3", pstd.fluid_density_kg_m3, Range::above(0.0));
    pstd.fluid_c_p_m_s = options.number_or("fluid_c_p_m_s", pstd.fluid_c_p_m_s, Range::above(0.0));
    static const std::array<std::string, 2> loads = {"traction", "displacement"};
    const auto moved_m = options.find_number("displacement_um", Range::above(0.0));
    if (options.find_choice("load", loads) == "displacement") pstd.load = PstdLoad::displacement;
    const bool moves = pstd.load == PstdLoad::displacement;
    if (moves && !options.has("displacement_um"))
        options.error("load", fmt::format("needs {}, how far the full load moves the skin",
                                          options.full("displacement_um")));
    if (!moves && options.has("displacement_um"))
        options.error("displacement_um",
                      fmt::format("is of {} = \"displacement\"", options.full("load")));
    pstd.displacement_m = moved_m.value_or(0.0);
    pstd.depth_m = options.number_or("depth_mm", 0.0, Range::above(0.0));
    const double points =
        options.number_or("absorbing_points", pstd.absorbing_points, Range::between(8, 100));
    if (points != std::floor(points)) options.error("absorbing_points", "must be a whole number");
    pstd.absorbing_points = static_cast<int>(points);
    pstd.absorbing_strength =
        options.number_or("absorbing_strength", pstd.absorbing_strength, Range::between(0.0, 20.0));
    static const std::array<std::string, 2> edges = {"periodic", "absorbing"};
    pstd.absorbing_edges = options.find_choice("edges", edges) == "absorbing";
    static const std::array<std::string, 2> precisions = {"double", "single"};
    if (options.find_choice("precision", precisions) == "single")
        pstd.precision = Precision::single_precision;
    options.finish();
    return pstd;
}

} // namespace

SolverOptions read_solver(Reader& reader, const TimeAxis& time, const StudyLoader& load_study) {
    static const std::array<std::string, 3> engines = {"layered", "spectral", "pstd"};
    const auto engine = reader.find_choice("engine", engines);
    // All tables are read: a sweep over the engine brings them, and their mistakes are told.
    const LayeredOptions layered = read_layered(reader.optional_table("layered"), time);
    const SpectralOptions spectral = read_spectral(reader.optional_table("spectral"), time);
    const PstdOptions pstd = read_pstd(reader.optional_table("pstd"), time, load_study);
    if (engine || !reader.has("engine")) reader.finish(); // else there may be its own table
    if (engine == "spectral") return spectral;
    if (engine == "pstd") return pstd;
    return layered;
}

} // namespace shearwake
