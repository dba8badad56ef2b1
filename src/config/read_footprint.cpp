#include "config/read_footprint.hpp"

#include "model/array_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace shearwake {
namespace {

struct ArrayPreset {
    std::string name;
    ArrayFootprint array;
};

const std::array<ArrayPreset, 2>& presets() {
    // 16 x 16: the 10 mm transducers of hobby and laboratory boards, 10.47 mm apart, of which the
    // active piston has a radius of 4.5 mm.
    // 249: AUTD3, whose published driver (hapislab, autd3-library-software) has 18 x 14 places
    // 10.16 mm apart, without numbers (1, 1), (2, 1) and (16, 1) for its screws; the piston is
    // ours.
    static const std::array<ArrayPreset, 2> all = {
        ArrayPreset{"array-16x16", {}},
        ArrayPreset{"array-249",
                    {.columns = 18, .rows = 14, .pitch_m = 10.16e-3, .missing = {19, 20, 34}}},
    };
    return all;
}

/// Air of 25 degrees, in which sound runs at 346.1 m/s.
constexpr double air_density_kg_m3 = 1.184;
/// The pattern is kept up to this many of its own widths.
constexpr double reach_in_widths = 4.0;

const std::vector<std::string>& preset_names() {
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
    const auto counts = reader.find_numbers("elements", Range::between(1, 100));
    if (!counts) return;
    if (counts->size() != 2 || counts->front() != std::floor(counts->front()) ||
        counts->back() != std::floor(counts->back())) {
        reader.error("elements", "must be two whole numbers, how many along x and along y");
        return;
    }
    array.columns = static_cast<std::ptrdiff_t>(counts->front());
    array.rows = static_cast<std::ptrdiff_t>(counts->back());
    array.missing.clear();
}

/// Pairs [column, row], counted from 1 at the least x and y.
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
            reader.error("missing", fmt::format("must hold places [column, row] from [1, 1] to "
                                                "[{}, {}], and holds [{:.6g}, {:.6g}]",
                                                array.columns, array.rows, place.x, place.y));
    }
    std::sort(array.missing.begin(), array.missing.end());
    array.missing.erase(std::unique(array.missing.begin(), array.missing.end()),
                        array.missing.end());
    if (std::ssize(array.missing) == array.columns * array.rows)
        reader.error("missing", "holds every element: one must be left");
}

void read_numbers(Reader& reader, ArrayFootprint& array, bool has_preset) {
    const auto read = [&](const char* key, double& value, const Range& range) {
        value = has_preset ? reader.number_or(key, value, range) : reader.number(key, range);
    };
    read("pitch_mm", array.pitch_m, Range::between(1.0, 100.0));
    read("radius_mm", array.radius_m, Range::between(0.1, 50.0));
    array.distance_m = reader.number("distance_mm", Range::between(20.0, 2000.0));
    array.center_m = reader.point_or("center_mm", {});
    array.frequency_Hz = reader.number_or("frequency_kHz", 40e3, Range::between(10.0, 200.0));
    array.sound_speed_m_s =
        reader.number_or("sound_speed_m_s", array.sound_speed_m_s, Range::between(100.0, 2000.0));
    const double levels = reader.number_or("phase_levels", 0.0, Range::between(2, 65536));
    if (levels != std::floor(levels)) reader.error("phase_levels", "must be a whole number");
    array.phase_levels = static_cast<int>(levels);
    array.update_rate_Hz = reader.number_or("update_rate_kHz", 0.0, Range::between(0.01, 1000.0));
}

FootprintAndPeak read_array(Reader& reader) {
    const std::size_t before = reader.findings().errors();
    ArrayFootprint array;
    const auto name = reader.find_choice("preset", preset_names());
    for (const ArrayPreset& preset : presets())
        if (name == preset.name) array = preset.array;
    const bool has_preset = reader.has("preset");
    read_elements(reader, array, has_preset);
    read_missing(reader, array);
    read_numbers(reader, array, has_preset);
    const auto strength_Pa_m = reader.find_number("pressure_Pa_m", Range::above(0.0));
    const double density_kg_m3 =
        reader.number_or("air_density_kg_m3", air_density_kg_m3, Range::above(0.0));
    const auto reach_m = reader.find_number("reach_mm", Range::between(5.0, 500.0));
    FootprintAndPeak read{.footprint = array, .gives_peak = reader.has("pressure_Pa_m")};
    reader.finish();
    if (reader.findings().errors() != before) return read;
    array.reach_m = reach_m ? *reach_m : reach_in_widths * fwhm_m(array);
    read.footprint = array;
    if (strength_Pa_m) read.peak_Pa = peak_Pa(array, *strength_Pa_m, density_kg_m3);
    return read;
}

} // namespace

FootprintAndPeak read_footprint(Reader reader) {
    static const std::array<std::string, 2> shapes = {"gaussian", "array"};
    if (reader.empty()) return {.footprint = GaussianFootprint{}};
    if (!reader.has("shape")) reader.missing("shape");
    const auto shape = reader.find_choice("shape", shapes);
    if (!shape && reader.has("shape")) return {.footprint = GaussianFootprint{}};
    if (shape == "array") return read_array(reader);
    GaussianFootprint footprint;
    footprint.fwhm_m = reader.number("fwhm_mm", Range::between(0.01, 1000.0));
    reader.finish();
    return {.footprint = footprint};
}

} // namespace shearwake
