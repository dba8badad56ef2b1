// SPDX-License-Identifier: BSD-3-Clause
#include "config/files/files.hpp"

#include "base/units.hpp"
#include "config/document/diagnostic.hpp"

#include <cmath>
#include <fmt/format.h>
#include <map>
#include <optional>

namespace shearwake::config {
namespace {

constexpr std::size_t most_rows = 100'000;
constexpr std::string_view heading = "x_mm,y_mm,class,row";

std::optional<ListedAfferent> afferent(const std::vector<std::string>& cells) {
    if (cells.size() != 4) return std::nullopt;
    const auto x_mm = finite_number_in(cells[0]), y_mm = finite_number_in(cells[1]),
               row = finite_number_in(cells[3]);
    const auto kind = class_named(cells[2]);
    if (!x_mm || !y_mm || !row || !kind || *row != std::floor(*row) || *row < 0.0 ||
        *row >= static_cast<double>(properties(*kind).neurons))
        return std::nullopt;
    return ListedAfferent{{*x_mm / 1000.0, *y_mm / 1000.0}, *kind, static_cast<std::size_t>(*row)};
}

/// "with row 0 to 3 (class SA1), 0 to 8 (class RA) or 0 to 3 (class PC)".
std::string rows_text() {
    std::string text = "with row ";
    for (const ReceptorClass& c : receptor_classes)
        text += fmt::format("{}0 to {} (class {})",
                            &c == &receptor_classes.front()  ? ""
                            : &c == &receptor_classes.back() ? " or "
                                                             : ", ",
                            c.neurons - 1, c.name);
    return text;
}

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

std::string first_problem(std::string_view csv,
                          const std::function<std::string(const CsvReader& row)>& problem_of) {
    CsvReader reader(csv);
    try {
        while (reader.next())
            if (const std::string problem = problem_of(reader); !problem.empty())
                return fmt::format("line {}: {}", reader.line(), problem);
    } catch (const CsvError& error) {
        return fmt::format("line {}: has {}", error.line, error.what());
    }
    return "";
}

AfferentsFile read_listed_afferents(std::string_view csv) {
    AfferentsFile file;
    bool has_heading = false;
    file.problem = first_problem(csv, [&](const CsvReader& row) -> std::string {
        if (!has_heading) {
            has_heading = fmt::format("{}", fmt::join(row.cells(), ",")) == heading;
            return has_heading ? ""
                               : fmt::format("must be the header {}, but is \"{}\"", heading,
                                             excerpt(row.text()));
        }
        const auto one = afferent(row.cells());
        if (!one)
            return fmt::format("must be {}, {}, but is \"{}\"", heading, rows_text(),
                               excerpt(row.text()));
        if (file.afferents.size() == most_rows)
            return fmt::format("exceeds the limit of {} afferents", most_rows);
        file.afferents.push_back(*one);
        return "";
    });
    if (file.problem.empty() && file.afferents.empty())
        file.problem =
            fmt::format("must contain at least one afferent below the header {}", heading);
    return file;
}

namespace {

PointsFile parsed_points(std::string_view csv, Columns columns) {
    PointsFile file;
    std::optional<Header> header;
    file.problem = first_problem(csv, [&](const CsvReader& row) -> std::string {
        const auto& cells = row.cells();
        if (!header) {
            header = header_of(cells, columns);
            if (header) return "";
            return fmt::format("must name two columns and their unit, as in x_mm,y_mm{}, but is "
                               "\"{}\"",
                               columns == Columns::rests && cells.size() > 2
                                   ? ", and possibly dwell_ms or t_ms, and then level"
                                   : "",
                               excerpt(row.text()));
        }
        std::vector<double> numbers;
        for (const std::string& cell : cells)
            if (const auto number = finite_number_in(cell)) numbers.push_back(*number);
        if (numbers.size() != cells.size() || cells.size() != header->width())
            return fmt::format("must be {} finite numbers {}, but is \"{}\"",
                               header->width() == 2 ? "two" : std::to_string(header->width()),
                               header->width() == 2 ? "x,y" : "as in the header",
                               excerpt(row.text()));
        const Vec2 point = {numbers[0] / header->per_m, numbers[1] / header->per_m};
        const bool rests = header->time_s > 0.0;
        if (!rests && !file.points_m.empty() && file.points_m.back() == point)
            return "repeats the previous point";
        if (file.points_m.size() == most_rows)
            return fmt::format("exceeds the limit of {} points", most_rows);
        file.points_m.push_back(point);
        if (!rests) return "";
        if (header->is_dwell && !(numbers[2] > 0.0)) return "has a dwell that is not above 0";
        file.rests_s.push_back(numbers[2] * header->time_s);
        if (!header->has_level) return "";
        if (!(numbers[3] >= 0.0 && numbers[3] <= 1.0))
            return "has a level that is not between 0 and 1";
        file.levels.push_back(numbers[3]);
        return "";
    });
    if (!file.problem.empty()) return file;
    if (header && header->time_s > 0.0 && !header->is_dwell)
        file.problem = rests_from_times(file.rests_s);
    if (file.points_m.size() < 2)
        file.problem = fmt::format("must contain at least 2 points below a header that names its "
                                   "columns, as in x_mm,y_mm, but contains {}",
                                   file.points_m.size());
    return file;
}

} // namespace

PointsFile read_points(std::string_view csv, Columns columns) {
    // Most cases of a sweep read the same file.
    struct Known {
        std::string csv;
        PointsFile file;
    };
    thread_local std::map<Columns, Known> last;
    Known& known = last[columns];
    if (known.csv.empty() || known.csv != csv)
        known = {std::string(csv), parsed_points(csv, columns)};
    return known.file;
}

} // namespace shearwake::config
