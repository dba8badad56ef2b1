// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "base/png.hpp"
#include "parallel/agree.hpp"
#include "problem/load/acoustics/lens_design.hpp"
#include "schedule/run/run.hpp"
#include "schedule/run/output_folder.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::app {
namespace {

struct LensArguments : schedule::JobArguments {
    std::filesystem::path out; // empty: out/<job name>.lens
};

HeightMap height_map(const LensFootprint& lens, const LensDesign& design) {
    HeightMap map{design.pixels, lens.pixel_m, {}};
    for (const double phase : design.phase_rad)
        map.heights_m.push_back(std::isnan(phase) ? 0.0 : thickness_m(lens, phase));
    return map;
}

/// A square map (x, y fastest) as a picture with y upwards, relative to its largest value.
std::string picture_of(std::ptrdiff_t side, const std::vector<double>& values) {
    image::GreyImage picture{side, side, {}};
    const double most = *std::max_element(values.begin(), values.end());
    for (std::ptrdiff_t row = 0; row < side; ++row)
        for (std::ptrdiff_t column = 0; column < side; ++column)
            picture.greys.push_back(
                values[static_cast<std::size_t>(column * side + side - 1 - row)] / most);
    return image::encode_png(picture);
}

std::string table_of(std::string_view header, std::ptrdiff_t side, const auto& place_mm,
                     const std::vector<double>& values, double scale) {
    std::string csv = fmt::format("{}\n", header);
    for (std::ptrdiff_t i = 0; i < side; ++i)
        for (std::ptrdiff_t j = 0; j < side; ++j)
            csv += fmt::format("{:.6g},{:.6g},{:.9g}\n", place_mm(i), place_mm(j),
                               scale * values[static_cast<std::size_t>(i * side + j)]);
    return csv;
}

/// The fraction of the incident power that a plate transmits, averaged over the pixels.
double mean_transmission(const LensFootprint& lens, const HeightMap& map) {
    double sum = 0.0, count = 0.0;
    for (const double height : map.heights_m) {
        if (height <= 0.0) continue;
        sum += transmission(lens, height);
        count += 1.0;
    }
    return count > 0.0 ? sum / count : 0.0;
}

void write_files(const std::filesystem::path& folder, const LensFootprint& lens,
                 const LensDesign& design, const HeightMap& map) {
    storage::make_directory(folder);
    storage::write_file(folder / "lens.stl", binary_stl(surface_of(map)));
    storage::write_file(folder / "thickness.png", picture_of(map.side, map.heights_m));
    storage::write_file(folder / "thickness.csv",
                        table_of(
                            "x_mm,y_mm,thickness_mm", map.side,
                            [&](std::ptrdiff_t i) {
                                return 1e3 * lens.pixel_m *
                                       (static_cast<double>(i) -
                                        0.5 * static_cast<double>(map.side - 1));
                            },
                            map.heights_m, 1e3));
    const Patch& pattern = design.pattern;
    storage::write_file(folder / "field.png", picture_of(pattern.side, pattern.values));
    storage::write_file(folder / "field.csv",
                        table_of(
                            "x_mm,y_mm,pressure", pattern.side,
                            [&](std::ptrdiff_t i) {
                                return 1e3 * (pattern.origin_m.x +
                                              static_cast<double>(i) * pattern.spacing_m);
                            },
                            pattern.values, 1.0));
    std::string errors = "iteration,error\n";
    for (std::size_t n = 0; n < design.errors.size(); ++n)
        errors += fmt::format("{},{:.9g}\n",
                              n + 1 < design.errors.size() ? fmt::format("{}", n + 1) : "rounded",
                              design.errors[n]);
    storage::write_file(folder / "errors.csv", errors);
}

void print(const std::filesystem::path& folder, const LensFootprint& lens, const LensDesign& design,
           const HeightMap& map) {
    const double thickest_m = *std::max_element(map.heights_m.begin(), map.heights_m.end());
    const double transmitted = mean_transmission(lens, map);
    fmt::print("lens: {0} x {0} pixels of {1:.4g} mm, {2:.4g} to {3:.4g} mm thick\n", map.side,
               1e3 * lens.pixel_m, 1e3 * lens.base_m, 1e3 * thickest_m);
    fmt::print("efficiency: {:.1f} % of the power behind the lens arrives at the target\n",
               100.0 * design.efficiency);
    fmt::print(
        "error: {:.4f} of the power behind the lens does not arrive as the target requires\n",
        design.errors.back());
    if (lens.foci_m.size() > 1)
        fmt::print("uniformity: {:.3f} over {} foci\n", design.uniformity, lens.foci_m.size());
    fmt::print("gain: the largest pressure on the skin is {:.3g} times that behind the lens, in a "
               "spot {:.3g} mm wide\n",
               design.gain, 1e3 * design.width_m);
    fmt::print("transmission: {:.3g} % of the power, estimated for plates of this material in "
               "air{}\n",
               100.0 * transmitted,
               transmitted < 0.1 ? "; the lens needs channels or cells that match the impedance of "
                                   "air"
                                 : "");
    fmt::print("files: {}: lens.stl, thickness.png, thickness.csv, field.png, field.csv, "
               "errors.csv\n",
               folder.string());
}

ExitCode lens_command(const LensArguments& arguments, const Comm& world) {
    const config::Job job = schedule::load_job(arguments.job, arguments.overrides, world);
    const auto* lens =
        std::get_if<LensFootprint>(&job.plan.cases.at(0).physics.scene.load.footprint);
    if (!lens)
        throw UsageError(arguments.job.string() +
                             ": the load of the first case is not a lens; set load.footprint.shape "
                             "= \"lens\"",
                         ExitCode::bad_job);
    on_root(world, [&] {
        print_override_warnings(job);
        const std::filesystem::path folder =
            schedule::output_folder(arguments.out, job.plan.name + ".lens").root;
        const auto design = design_of(*lens);
        const HeightMap map = height_map(*lens, *design);
        write_files(folder, *lens, *design, map);
        print(folder, *lens, *design, map);
    });
    return ExitCode::done;
}

} // namespace

void add_lens(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<LensArguments>(
        app, action, "lens",
        "write the thickness (STL, PNG) and the field of the acoustic lens of a job", lens_command);
    add_job(command, arguments);
    command.add_option("--out", arguments.out, "output folder (default: out/<job name>.lens)");
}

} // namespace shearwake::app
