// SPDX-License-Identifier: BSD-3-Clause
#include "config/files/points_file.hpp"

#include "base/csv.hpp"
#include "base/units.hpp"
#include "config/document/diagnostic.hpp"

#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace shearwake::config {
namespace {

constexpr std::size_t most_points = 100'000;

/// The columns of a file, by their names.
struct Header {
    double per_m = 0.0;  // number of units of the places per metre
    double time_s = 0.0; // the unit of the third column; 0: there is none
    bool is_dwell = false, has_level = false;

    std::size_t width() const { return 2 + (time_s > 0.0 ? 1 : 0) + (has_level ? 1 : 0); }
};

std::optional<Header> header_of(const std::vector<std::string>& names, Columns columns) {
    if (names.size() < 2 || without_unit(names[0]) != "x" || without_unit(names[1]) != "y")
        return std::nullopt;
    const auto x = unit_of(names[0]), y = unit_of(names[1]);
    if (!x || !y || x->suffix != y->suffix || x->quantity != "length") return std::nullopt;
    // Division is exact here: 49 / 1000 is the double closest to 0.049.
    Header header{.per_m = std::round(1.0 / x->to_SI)};
    std::size_t at = 2;
    if (columns == Columns::rests && at < names.size()) {
        const auto unit = unit_of(names[at]);
        const std::string_view name = without_unit(names[at]);
        if (!unit || unit->quantity != "time" || (name != "t" && name != "dwell"))
            return std::nullopt;
        header.time_s = unit->to_SI;
        header.is_dwell = name == "dwell";
        if (++at < names.size() && names[at] == "level") {
            header.has_level = true;
            ++at;
        }
    }
    return at == names.size() ? std::optional(header) : std::nullopt;
}

/// From the times at which the rests begin to their durations; the reason why this is impossible.
std::string rests_from_times(std::vector<double>& times_s) {
    if (times_s.size() < 2) return "";
    if (times_s.front() != 0.0) return "the first time must be 0";
    for (std::size_t i = 0; i + 1 < times_s.size(); ++i) {
        if (!(times_s[i + 1] > times_s[i]))
            return fmt::format("the times must ascend, but that of point {} does not", i + 2);
        times_s[i] = times_s[i + 1] - times_s[i];
    }
    times_s.back() = times_s[times_s.size() - 2];
    return "";
}

} // namespace

PointsFile read_points(std::string_view csv, Columns columns) {
    PointsFile file;
    std::optional<Header> header;
    CsvReader reader(csv);
    const auto refuse = [&](std::size_t line, std::string_view what) {
        return PointsFile{.problem = fmt::format("line {}: {}", line, what)};
    };
    while (true) {
        try {
            if (!reader.next()) break;
        } catch (const CsvError& error) {
            return refuse(error.line, fmt::format("has {}", error.what()));
        }
        const auto& cells = reader.cells();
        if (!header) {
            header = header_of(cells, columns);
            if (header) continue;
            return refuse(
                reader.line(),
                fmt::format("must name two columns and their unit, as in x_mm,y_mm{}, but is "
                            "\"{}\"",
                            columns == Columns::rests && cells.size() > 2
                                ? ", and possibly dwell_ms or t_ms, and then level"
                                : "",
                            excerpt(reader.text())));
        }
        std::vector<double> numbers;
        for (const std::string& cell : cells)
            if (const auto number = finite_number_in(cell)) numbers.push_back(*number);
        if (numbers.size() != cells.size() || cells.size() != header->width())
            return refuse(
                reader.line(),
                fmt::format("must be {} finite numbers {}, but is \"{}\"",
                            header->width() == 2 ? "two" : std::to_string(header->width()),
                            header->width() == 2 ? "x,y" : "as in the header",
                            excerpt(reader.text())));
        const Vec2 point = {numbers[0] / header->per_m, numbers[1] / header->per_m};
        const bool rests = header->time_s > 0.0;
        if (!rests && !file.points_m.empty() && file.points_m.back() == point)
            return refuse(reader.line(), "repeats the previous point");
        if (file.points_m.size() == most_points)
            return refuse(reader.line(),
                          fmt::format("exceeds the limit of {} points", most_points));
        file.points_m.push_back(point);
        if (!rests) continue;
        if (header->is_dwell && !(numbers[2] > 0.0))
            return refuse(reader.line(), "has a dwell that is not above 0");
        file.rests_s.push_back(numbers[2] * header->time_s);
        if (!header->has_level) continue;
        if (!(numbers[3] >= 0.0 && numbers[3] <= 1.0))
            return refuse(reader.line(), "has a level that is not between 0 and 1");
        file.levels.push_back(numbers[3]);
    }
    if (header && header->time_s > 0.0 && !header->is_dwell)
        file.problem = rests_from_times(file.rests_s);
    if (file.points_m.size() < 2)
        file.problem = fmt::format("must contain at least 2 points below a header that names its "
                                   "columns, as in x_mm,y_mm, but contains {}",
                                   file.points_m.size());
    return file;
}

} // namespace shearwake::config
