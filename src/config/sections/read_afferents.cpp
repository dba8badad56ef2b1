// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_case.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "config/document/job_keys.hpp"
#include "config/files/files.hpp"
#include "config/sections/read_fields.hpp"
#include "problem/load/footprint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::config {
namespace {

constexpr double most_points = 1e5; // limit for a grid of pins or afferents
/// Limit for pins that are placed along a long path; their spacing is increased accordingly.
constexpr double most_default_pins = 100.0;

void require(Reader& reader, const char* key, bool has_use, const char* where) {
    if (!has_use && reader.has(key)) reader.error(key, fmt::format("applies only with {}", where));
}

AfferentPlaces read_list(Reader& reader, const TextLoader& load_text) {
    if (!reader.has("file")) reader.missing("file");
    const auto text = load_named(reader, "file", load_text);
    if (!text) return AfferentList{};
    AfferentsFile file = read_listed_afferents(*text);
    if (!file.problem.empty())
        reader.error("file",
                     fmt::format("cannot be used: {}: {}", reader.word("file"), file.problem));
    return AfferentList{std::move(file.afferents)};
}

AfferentPlaces read_grid(Reader& reader) {
    GridAfferents grid;
    read_fields(reader, grid);
    const double points =
        (grid.extent_m.x / grid.pitch_m + 1.0) * (grid.extent_m.y / grid.pitch_m + 1.0);
    if (!(points <= most_points))
        reader.error("pitch_mm",
                     fmt::format("results in {:.0f} points; at most {:.0f} are supported", points,
                                 most_points));
    return grid;
}

AfferentPlaces read_places(Reader& reader, const TextLoader& load_text) {
    const std::string where = read_optional_word(reader, field_of<AfferentOptions>("where"));
    require(reader, "extent_mm", where == "grid", "where = \"grid\"");
    require(reader, "pitch_mm", where == "grid", "where = \"grid\"");
    require(reader, "file", where == "csv", "where = \"csv\"");
    if (where == "csv" || where == "grid") require(reader, "digit", false, "where = \"fingertip\"");
    if (where == "csv" && reader.has("classes"))
        reader.error("classes",
                     "does not apply to where = \"csv\": the file specifies the classes");
    if (where == "csv") return read_list(reader, load_text);
    if (where == "grid") return read_grid(reader);
    HandAfferents part{.part = where};
    read_fields(reader, part);
    return part;
}

std::vector<AfferentClass> read_classes(Reader& reader) {
    const auto names = reader.find_words("classes");
    if (!names) return {all_classes.begin(), all_classes.end()};
    constexpr auto class_names = names_of(std::type_identity<AfferentClass>{});
    const std::vector<std::string> known(class_names.begin(), class_names.end());
    std::vector<AfferentClass> classes; // in a fixed order, without duplicates
    for (const AfferentClass kind : all_classes)
        if (std::find(names->begin(), names->end(), name_of(kind)) != names->end())
            classes.push_back(kind);
    for (const std::string& name : *names)
        if (!class_named(name))
            reader.error("classes", fmt::format("must contain only {}, but contains \"{}\"",
                                                quoted_list(known, "and"), excerpt(name)));
    if (names->empty())
        reader.error("classes", "must contain at least one class: " + quoted_list(known));
    return classes;
}

CarrierInput read_carrier(Reader table) {
    CarrierInput carrier{.am_depth = 1.0};
    read_fields(table, carrier);
    const double fewest_Hz = fewest_samples_a_cycle * carrier.frequency_Hz;
    if (!table.has("sampling_kHz")) carrier.sampling_Hz = std::max(5000.0, fewest_Hz);
    if (carrier.am_frequency_Hz == 0.0) {
        if (table.has("am_depth") && carrier.am_depth > 0.0)
            table.error("am_depth", "requires am_frequency_Hz above 0");
        carrier.am_depth = 0.0;
    }
    if (carrier.sampling_Hz < fewest_Hz * (1.0 - 1e-9))
        table.error("sampling_kHz",
                    fmt::format("gives {:.3g} samples per cycle of {:g} kHz, so the sampled "
                                "carrier is aliased; it must be at least {:g}",
                                carrier.sampling_Hz / carrier.frequency_Hz,
                                1e-3 * carrier.frequency_Hz, 1e-3 * fewest_Hz));
    table.finish();
    return carrier;
}

AfferentInput read_input(Reader& reader) {
    const std::string input =
        reader.find_choice("input", alternative_names<AfferentInput>()).value_or(PinInput::name);
    require(reader, "carrier", input == "carrier", "input = \"carrier\"");
    if (input == "stress") return StressInput{};
    if (input == "carrier") return read_carrier(reader.table("carrier"));
    return PinInput{};
}

std::vector<Vec2> read_pin_line(Reader table) {
    PinLineKeys line;
    read_fields(table, line);
    table.finish();
    if (table.empty()) return {{}}; // already reported
    std::vector<Vec2> pins_m;
    for (int i = 0; i < line.count; ++i)
        pins_m.push_back(line.from_m + static_cast<double>(i) /
                                           (static_cast<double>(line.count) - 1.0) *
                                           (line.to_m - line.from_m));
    return pins_m;
}

std::vector<Vec2> read_pin_grid(Reader table) {
    const std::size_t before = table.diagnostics().errors();
    PinGridKeys grid;
    read_fields(table, grid);
    table.finish();
    if (table.empty() || table.diagnostics().errors() > before) return {{}}; // already reported
    const auto half = [&](double length_m) {
        return std::floor(0.5 * length_m / grid.pitch_m + 1e-9);
    };
    std::vector<Vec2> pins_m;
    const double half_x = half(grid.extent_m.x), half_y = half(grid.extent_m.y);
    if ((2.0 * half_x + 1.0) * (2.0 * half_y + 1.0) > 1000.0) {
        table.error("pitch_mm", fmt::format("results in {:.0f} pins; at most 1000 are supported",
                                            (2.0 * half_x + 1.0) * (2.0 * half_y + 1.0)));
        return {{}};
    }
    for (double i = -half_x; i <= half_x; ++i)
        for (double j = -half_y; j <= half_y; ++j)
            pins_m.push_back(grid.center_m + grid.pitch_m * Vec2{i, j});
    return pins_m;
}

double length_of(const std::vector<std::vector<Vec2>>& lines) {
    double length_m = 0.0;
    for (const auto& line : lines)
        for (std::size_t i = 1; i < line.size(); ++i)
            length_m += norm(line[i] - line[i - 1]);
    return length_m;
}

/// Pins at the foci, or along the drawn path about one FWHM apart, without overlap and within the
/// domain.
std::vector<Vec2> pins_on_path(const Load& load, const Domain& domain, double radius_m) {
    const double wide_m = std::max(fwhm_m(load.footprint), 2.0 * radius_m);
    if (!(wide_m > 0.0) || domain.nx == 0) return {{}}; // already reported
    const double length_m = length_of(drawn_shape(load.modulation, wide_m));
    const double step_m = std::max(wide_m, length_m / most_default_pins);
    const double apart_m = std::max(0.5 * step_m, 2.0 * radius_m) * (1.0 - 1e-9);
    std::vector<Vec2> pins_m;
    for (const auto& line : drawn_shape(load.modulation, step_m))
        for (const Vec2 point_m : line)
            if (domain.contains(point_m) && std::ranges::none_of(pins_m, [&](Vec2 pin_m) {
                    return norm(pin_m - point_m) < apart_m;
                }))
                pins_m.push_back(point_m);
    return pins_m.empty() ? std::vector<Vec2>{{}} : pins_m;
}

std::vector<Vec2> read_pins(Reader& reader, const Domain& domain, std::vector<Vec2> pins_m) {
    const int given = reader.has("pins_mm") + reader.has("pin_line") + reader.has("pin_grid");
    const char* key = "pins_mm";
    if (given > 1)
        reader.error("pins_mm", "cannot be combined with pin_line or pin_grid, nor these with each "
                                "other; remove one of them from the job");
    if (const auto points_m = reader.find_points("pins_mm")) pins_m = *points_m;
    if (reader.has("pin_line")) {
        pins_m = read_pin_line(reader.optional_table("pin_line"));
        key = "pin_line";
    }
    if (reader.has("pin_grid")) {
        pins_m = read_pin_grid(reader.optional_table("pin_grid"));
        key = "pin_grid";
    }
    if (pins_m.empty() || pins_m.size() > 1000)
        reader.error(key,
                     fmt::format("must contain 1 to 1000 pins, but contains {}", pins_m.size()));
    for (const Vec2& pin_m : pins_m) {
        if (domain.nx == 0 || domain.contains(pin_m)) continue;
        reader.error(key, fmt::format("must lie inside the domain, within {:.6g} and {:.6g} mm of "
                                      "its centre; [{:.6g}, {:.6g}] does not",
                                      500.0 * domain.extent_x_m(), 500.0 * domain.extent_y_m(),
                                      1e3 * pin_m.x, 1e3 * pin_m.y));
        break;
    }
    return pins_m;
}

} // namespace

std::optional<AfferentOptions> read_afferents(Reader& reader, const Domain& domain,
                                              const Load* load, const TextLoader& load_text) {
    if (reader.empty()) return std::nullopt;
    AfferentOptions options;
    options.places = read_places(reader, load_text);
    options.classes = read_classes(reader);
    read_fields(reader, options);
    static const std::array<std::string, 2> sheets = {"hand", "flat"};
    const bool on_hand = std::holds_alternative<HandAfferents>(options.places);
    options.sheet = reader.choice_or("skin", on_hand ? "hand" : "flat", sheets) == "hand"
                        ? SkinSheet::hand
                        : SkinSheet::flat;
    options.input = read_input(reader);
    // The motion of the simulated skin is felt where the focus is. Prescribed pins are independent
    // of the load, and the input "stress" has none.
    const bool follows = load && follows_skin(options.input);
    options.pins_m = read_pins(reader, domain,
                               follows ? pins_on_path(*load, domain, options.pin_radius_m)
                                       : std::vector<Vec2>{{}});
    reader.finish();
    return options;
}

} // namespace shearwake::config
