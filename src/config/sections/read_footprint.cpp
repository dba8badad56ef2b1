// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_case.hpp"

#include "base/error.hpp"
#include "base/png.hpp"
#include "base/text.hpp"
#include "config/sections/read_fields.hpp"
#include "problem/load/acoustics/lens_design.hpp"
#include "problem/load/array_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::config {
namespace {

/// The air of the default absorption.
constexpr double temperature_K = 298.15, humidity = 0.5;
/// Default reach of the pattern beyond the target, in widths of a focus.
constexpr double widths_around = 4.0;
/// Largest lattice: its fields need 250 MB.
constexpr std::ptrdiff_t largest_side = 800;
/// Largest number of points times corners of the target, each of which takes 16 tests: 1 s.
constexpr double most_corner_tests = 2e7;
constexpr std::size_t most_corners = 10000;

std::vector<Vec2> read_points_of(Reader& reader, const char* key, std::size_t least) {
    std::vector<Vec2> points = reader.find_points(key).value_or(std::vector<Vec2>());
    if (reader.has(key) && (points.size() < least || points.size() > most_corners))
        reader.error(key, fmt::format("must contain {} to {} points", least, most_corners));
    return points;
}

JobImage image_of(const std::string& bytes) {
    image::DecodedImage decoded = image::decode_png(bytes);
    if (decoded.problem.empty() &&
        std::ranges::count(decoded.greys, 0) == std::ssize(decoded.greys))
        decoded.problem = "it is black, so it requests no radiation pressure";
    auto image = std::make_shared<TargetImage>(
        TargetImage{decoded.columns, decoded.rows, {}, hex(stable_hash(std::string_view(bytes)))});
    image->greys.reserve(decoded.greys.size());
    for (const std::uint8_t grey : decoded.greys)
        image->greys.push_back(grey / 255.0);
    return {std::move(image), decoded.problem};
}

std::shared_ptr<const TargetImage> read_image(Reader& reader, const FileLoaders& files) {
    const auto name = reader.find_word("target_png");
    if (!name) return nullptr;
    if (!files.images->contains(*name)) {
        const auto bytes = load_named(reader, "target_png", files.load_text);
        if (!bytes) return nullptr;
        files.images->emplace(*name, image_of(*bytes));
    }
    const JobImage& read = files.images->at(*name);
    if (read.problem.empty()) return read.image;
    reader.error("target_png", fmt::format("cannot be used: {}: {}", *name, read.problem));
    return nullptr;
}

void read_target(Reader& reader, const FileLoaders& files, LensFootprint& lens) {
    lens.foci_m = read_points_of(reader, "target_foci_mm", 1);
    lens.polygon_m = read_points_of(reader, "target_polygon_mm", 3);
    lens.image = read_image(reader, files);
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

/// A footprint with shape = "lens". Its design is computed, or taken from those of the same job.
FootprintAndPeak read_lens(Reader& reader, const FileLoaders& files) {
    const std::size_t before = reader.diagnostics().errors();
    LensFootprint lens;
    read_fields(reader, lens);
    read_target(reader, files, lens);
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
    FootprintAndPeak read{.defines_peak = reader.has("pressure_Pa")};
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

struct ArrayPreset {
    std::string name;
    std::string source;
    ArrayFootprint array;
};

const std::array<ArrayPreset, 2>& presets() {
    static const std::array<ArrayPreset, 2> all = {
        ArrayPreset{"array-16x16",
                    "The 10 mm transducers of hobby and laboratory boards at a pitch of 10.47 mm, "
                    "whose active piston has a radius of 4.5 mm.",
                    {}},
        ArrayPreset{"array-249",
                    "AUTD3, whose published driver (hapislab, autd3-library-software) has 18 x 14 "
                    "positions at a pitch of 10.16 mm, of which (1, 1), (2, 1) and (16, 1) are "
                    "occupied by screws. Chosen for this program: the radius of the piston.",
                    {.columns = 18, .rows = 14, .pitch_m = 10.16e-3, .missing = {19, 20, 34}}},
    };
    return all;
}

/// Samples per wavelength of a pattern, see ArrayField.
constexpr double samples_a_wavelength = 6.5;
/// Default reach of the pattern, in multiples of its width.
constexpr double reach_in_widths = 4.0;
/// Largest number of samples of a pattern along a side, and largest number of samples times
/// elements: a second for the properties of the pattern.
constexpr double most_pattern_side = 600.0, most_products = 1e8;
/// Largest number of samples of the table of a piston along a side: 128 MB.
constexpr double most_table_samples = 4000.0;
/// Largest work for all arrays of a job, in such products: about 2 s. The width of a pattern
/// takes 1e4 products per element, and each of the different samples of the table 150.
constexpr double most_work = 2e9, width_products = 1e4, table_products = 150.0;

const std::vector<std::string>& array_preset_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const ArrayPreset& preset : presets())
            all.push_back(preset.name);
        return all;
    }();
    return names;
}

void read_elements(Reader& reader, ArrayFootprint& array, bool has_preset) {
    if (!has_preset && !reader.has("elements")) reader.missing("elements");
    const auto counts = find_integer_pair(reader, "elements", range_of<ArrayFootprint>("elements"),
                                          ", the number of elements along x and along y");
    if (!counts) return;
    array.columns = counts->front();
    array.rows = counts->back();
    array.missing.clear();
}

/// Pairs [column, row], counted from 1 at the smallest x and y.
void read_missing(Reader& reader, ArrayFootprint& array) {
    const auto places = reader.find_points("missing");
    if (!places) return;
    array.missing.clear();
    for (const Vec2& place : *places) {
        const auto column = static_cast<std::ptrdiff_t>(place.x),
                   row = static_cast<std::ptrdiff_t>(place.y);
        const bool is_there = static_cast<double>(column) == place.x &&
                              static_cast<double>(row) == place.y && column >= 1 && row >= 1 &&
                              column <= array.columns && row <= array.rows;
        if (is_there)
            array.missing.push_back(column - 1 + (row - 1) * array.columns);
        else
            reader.error("missing", fmt::format("must contain positions [column, row] from [1, 1] "
                                                "to [{}, {}], but contains [{:.6g}, {:.6g}]",
                                                array.columns, array.rows, place.x, place.y));
    }
    std::sort(array.missing.begin(), array.missing.end());
    array.missing.erase(std::unique(array.missing.begin(), array.missing.end()),
                        array.missing.end());
    if (std::ssize(array.missing) == array.columns * array.rows)
        reader.error("missing", "contains every element; at least one must remain");
}

/// Samples along a side of the pattern and of the table.
struct PatternSize {
    explicit PatternSize(const ArrayFootprint& array) {
        const double spacing_m = array.sound_speed_m_s / array.frequency_Hz / samples_a_wavelength;
        side = 2.0 * fading_end_m(array.reach_m) / spacing_m;
        table = side + static_cast<double>(std::max(array.columns, array.rows)) * array.pitch_m /
                           spacing_m;
        elements = static_cast<double>(array.columns * array.rows);
    }
    double work() const {
        return (side * side + width_products) * elements + table_products / 8.0 * table * table;
    }
    double side, table, elements;
};

/// Adds an array to those of the job, which must not require too much work together.
void add_array(Reader& reader, const ArrayFootprint& array, JobArrays& arrays) {
    if (std::ranges::find(arrays.known, array) != arrays.known.end()) return;
    const double work = PatternSize(array).work();
    double all = work;
    for (const ArrayFootprint& one : arrays.known)
        all += PatternSize(one).work();
    arrays.known.push_back(array);
    if (std::max(all, arrays.expected_1 * work) > most_work)
        reader.error(
            "shape",
            fmt::format("= \"array\": the job has {:.0f} different arrays, but at most "
                        "{:.0f} of this size are supported; divide it into several jobs",
                        std::max(arrays.expected_1, static_cast<double>(arrays.known.size())),
                        std::floor(most_work / work)));
}

void check_array(Reader& reader, const ArrayFootprint& array) {
    const auto [side, table, elements] = PatternSize(array);
    if (side > most_pattern_side)
        reader.error("reach_mm",
                     fmt::format("requires {:.4g} x {:.4g} samples of the pattern, but at most "
                                 "{:.0f} x {:.0f} are supported; reduce it or the frequency",
                                 side, side, most_pattern_side, most_pattern_side));
    const double products = side * side * elements;
    if (products > most_products)
        reader.error(
            "elements",
            fmt::format("and reach_mm require {:.2g} products of samples and elements, but "
                        "at most {:.2g} are supported; reduce them",
                        products, most_products));
    if (table > most_table_samples)
        reader.error("elements",
                     fmt::format("and pitch_mm require a table of {:.4g} x {:.4g} samples, but at "
                                 "most {:.0f} x {:.0f} are supported; reduce them or the frequency",
                                 table, table, most_table_samples, most_table_samples));
}

FootprintAndPeak read_array(Reader& reader, const FileLoaders& files) {
    const std::size_t before = reader.diagnostics().errors();
    ArrayFootprint array;
    const auto name = reader.find_choice("preset", array_preset_names());
    for (const ArrayPreset& preset : presets())
        if (name == preset.name) array = preset.array;
    const bool has_preset = reader.has("preset");
    read_elements(reader, array, has_preset);
    read_missing(reader, array);
    read_fields(reader, array, {.has_preset = has_preset});
    const auto strength_Pa_m =
        reader.find_number("pressure_Pa_m", range_of<ArrayFootprint>("pressure_Pa_m"));
    const double density_kg_m3 = reader.number_or("air_density_kg_m3", air_density_kg_m3,
                                                  range_of<ArrayFootprint>("air_density_kg_m3"));
    const auto reach_m = reader.find_number("reach_mm", range_of<ArrayFootprint>("reach_mm"));
    FootprintAndPeak read{.footprint = array, .defines_peak = reader.has("pressure_Pa_m")};
    reader.finish();
    if (reader.diagnostics().errors() != before) return read;
    array.reach_m = reach_m ? *reach_m : reach_in_widths * fwhm_m(array);
    check_array(reader, array);
    add_array(reader, array, *files.arrays);
    if (reader.diagnostics().errors() != before) return read;
    read.footprint = array;
    if (strength_Pa_m) read.peak_Pa = peak_Pa(array, *strength_Pa_m, density_kg_m3);
    return read;
}

} // namespace

std::string array_presets() {
    std::string text = "\n# Arrays: [load.footprint] shape = \"array\", preset = \"NAME\".\n";
    for (const ArrayPreset& preset : presets())
        text += fmt::format("\n# {}\n# {}\nelements = [{}, {}] # {} of them missing\n"
                            "pitch_mm = {:.6g}\nradius_mm = {:.6g}\nfrequency_kHz = {:.6g}\n",
                            preset.name, preset.source, preset.array.columns, preset.array.rows,
                            preset.array.missing.size(), 1e3 * preset.array.pitch_m,
                            1e3 * preset.array.radius_m, 1e-3 * preset.array.frequency_Hz);
    return text;
}

FootprintAndPeak read_footprint(Reader reader, const FileLoaders& files) {
    if (reader.empty()) return {.footprint = GaussianFootprint{}};
    if (!reader.has("shape")) reader.missing("shape");
    const auto shape = reader.find_choice("shape", alternative_names<Footprint>());
    if (!shape && reader.has("shape")) return {.footprint = GaussianFootprint{}};
    if (shape == ArrayFootprint::name) return read_array(reader, files);
    if (shape == LensFootprint::name) return read_lens(reader, files);
    GaussianFootprint footprint;
    read_fields(reader, footprint);
    reader.finish();
    return {.footprint = footprint};
}

} // namespace shearwake::config
