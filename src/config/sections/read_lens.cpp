// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_lens.hpp"

#include "base/error.hpp"
#include "base/png.hpp"
#include "config/sections/read_fields.hpp"
#include "problem/load/acoustics/lens_design.hpp"
#include "problem/load/acoustics/plane_propagation.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::config {

namespace {

/// The air of the default absorption.
constexpr double temperature_K = 298.15, humidity = 0.5;
/// Default reach of the pattern beyond the target, in widths of a focus.
constexpr double widths_around = 4.0;
/// Largest lattice: its fields need 250 MB.
constexpr std::ptrdiff_t largest_side = 1000;
/// Largest number of points times corners of the target, each of which takes 16 tests: 1 s.
constexpr double most_corner_tests = 2e7;
constexpr std::size_t most_corners = 10000;

std::vector<Vec2> read_points_of(Reader& reader, const char* key, std::size_t least) {
    std::vector<Vec2> points = reader.find_points(key).value_or(std::vector<Vec2>());
    if (reader.has(key) && (points.size() < least || points.size() > most_corners))
        reader.error(key, fmt::format("must contain {} to {} points", least, most_corners));
    return points;
}

std::shared_ptr<const TargetImage> read_image(Reader& reader, const TextLoader& load_text) {
    const auto name = reader.find_word("target_png");
    if (!name) return nullptr;
    if (!load_text) {
        reader.error("target_png", "names a file, but this job is read without access to files");
        return nullptr;
    }
    try {
        const std::string bytes = load_text(*name);
        image::DecodedImage decoded = image::decode_png(bytes);
        const auto& greys = decoded.image.greys;
        if (decoded.problem.empty() &&
            std::none_of(greys.begin(), greys.end(), [](double grey) { return grey > 0.0; }))
            decoded.problem = "it is black, so it requests no radiation pressure";
        if (decoded.problem.empty())
            return std::make_shared<const TargetImage>(
                TargetImage{decoded.image.columns, decoded.image.rows, greys,
                            hex(stable_hash(std::string_view(bytes)))});
        reader.error("target_png", fmt::format("cannot be used: {}: {}", *name, decoded.problem));
    } catch (const UsageError& problem) {
        reader.error("target_png", fmt::format("cannot be used: {}", problem.what()));
    }
    return nullptr;
}

void read_target(Reader& reader, const TextLoader& load_text, LensFootprint& lens) {
    lens.foci_m = read_points_of(reader, "target_foci_mm", 1);
    lens.polygon_m = read_points_of(reader, "target_polygon_mm", 3);
    lens.image = read_image(reader, load_text);
    const auto width_m =
        reader.find_number("target_width_mm", range_of<LensFootprint>("target_width_mm"));
    int targets = 0;
    for (const char* key : {"target_foci_mm", "target_polygon_mm", "target_png"})
        targets += reader.has(key);
    if (targets != 1)
        reader.error("shape", "= \"lens\" requires exactly one of target_foci_mm, "
                              "target_polygon_mm and target_png");
    if (reader.has("target_png") && !width_m) reader.missing("target_width_mm");
    if (width_m && !reader.has("target_png"))
        reader.error("target_width_mm", "applies only with target_png");
    lens.image_width_m = width_m.value_or(0.0);
}

/// The lattice of a lens whose keys are valid, and its target must fit in front of each other.
void check_lens(Reader& reader, const LensFootprint& lens) {
    if (lens.pixel_m > 0.25 * lens.aperture_m)
        reader.error("pixel_mm", "must be at most a quarter of aperture_mm");
    if (lens.material_c_m_s == lens.sound_speed_m_s)
        reader.error("material_c_m_s", "is equal to that of air, so the thickness of the lens has "
                                       "no effect on the phase");
    if (target_extent_m(lens) > lens.reach_m)
        reader.error("reach_mm",
                     fmt::format("must be at least {:.4g}, so that it contains the target",
                                 1e3 * target_extent_m(lens)));
    const std::ptrdiff_t side = lattice(lens).side;
    if (side > largest_side)
        reader.error("aperture_mm",
                     fmt::format("and reach_mm require a lattice of {} x {} points, but at most {} "
                                 "x {} are supported; reduce them, move the target towards the "
                                 "axis, or increase pixel_mm",
                                 side, side, largest_side, largest_side));
    const double points = static_cast<double>(side) * static_cast<double>(side);
    const auto corners = static_cast<double>(lens.polygon_m.size() + lens.foci_m.size());
    if (side <= largest_side && points * corners > most_corner_tests)
        reader.error(lens.foci_m.empty() ? "target_polygon_mm" : "target_foci_mm",
                     fmt::format("has {:.0f} points, which are compared with {} x {} points of the "
                                 "lattice; at most {:.0f} are supported on it",
                                 corners, side, side, most_corner_tests / points));
}

} // namespace

FootprintAndPeak read_lens(Reader& reader, const FileLoaders& files) {
    const std::size_t before = reader.diagnostics().errors();
    LensFootprint lens;
    read_fields(reader, lens);
    read_target(reader, files.load_text, lens);
    lens.absorption_dB_m = reader.number_or(
        "absorption_dB_m", air_absorption_dB_m(lens.frequency_Hz, temperature_K, humidity),
        range_of<LensFootprint>("absorption_dB_m"));
    lens.pixel_m = reader.number_or("pixel_mm", 0.25 * wavelength_m(lens),
                                    range_of<LensFootprint>("pixel_mm"));
    const auto reach_m = reader.find_number("reach_mm", range_of<LensFootprint>("reach_mm"));
    const auto pressure_Pa =
        reader.find_number("pressure_Pa", range_of<LensFootprint>("pressure_Pa"));
    const double density_kg_m3 = reader.number_or("air_density_kg_m3", air_density_kg_m3,
                                                  range_of<LensFootprint>("air_density_kg_m3"));
    FootprintAndPeak read{.gives_peak = reader.has("pressure_Pa")};
    reader.finish();
    if (reader.diagnostics().errors() != before) return read;
    lens.reach_m = reach_m.value_or(target_extent_m(lens) + widths_around * focal_width_m(lens));
    check_lens(reader, lens);
    if (reader.diagnostics().errors() != before) return read;
    try {
        lens.design = files.lenses->of(lens);
    } catch (const UsageError& error) {
        reader.error("iterations", error.what());
        return read;
    }
    const double amplitude_Pa = pressure_Pa.value_or(0.0) * lens.design->gain;
    if (pressure_Pa)
        read.peak_Pa = amplitude_Pa * amplitude_Pa /
                       (density_kg_m3 * lens.sound_speed_m_s * lens.sound_speed_m_s);
    read.footprint = std::move(lens);
    return read;
}

} // namespace shearwake::config
