#include "config/points_file.hpp"

#include "base/units.hpp"
#include "config/finding.hpp"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace shearwake {
namespace {

constexpr std::size_t most_points = 100'000;

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// The two cells of a line; nothing if there are not two.
std::optional<std::pair<std::string_view, std::string_view>> cells(std::string_view line) {
    const std::size_t comma = line.find(',');
    if (comma == std::string_view::npos || line.find(',', comma + 1) != std::string_view::npos)
        return std::nullopt;
    return std::pair{trimmed(line.substr(0, comma)), trimmed(line.substr(comma + 1))};
}

std::optional<double> number(std::string_view text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_whole = error == std::errc() && end == text.data() + text.size();
    return is_whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// What the columns' unit is in m, from their names.
std::optional<double> unit_m(std::string_view line) {
    const auto names = cells(line);
    if (!names || without_unit(names->first) != "x" || without_unit(names->second) != "y")
        return std::nullopt;
    const auto x = unit_of(names->first), y = unit_of(names->second);
    if (!x || !y || x->suffix != y->suffix || x->quantity != "length") return std::nullopt;
    return x->to_SI;
}

} // namespace

PointsFile read_points(std::string_view csv) {
    PointsFile file;
    std::optional<double> unit;
    const auto refuse = [&](std::size_t line, std::string_view what) {
        return PointsFile{{}, fmt::format("line {}: {}", line, what)};
    };
    std::size_t number_of_line = 0;
    while (!csv.empty()) {
        const std::size_t end = std::min(csv.find('\n'), csv.size());
        const std::string_view line = trimmed(csv.substr(0, end));
        csv.remove_prefix(std::min(end + 1, csv.size()));
        ++number_of_line;
        if (line.empty() || line.front() == '#') continue;
        if (!unit) {
            unit = unit_m(line);
            if (unit) continue;
            return refuse(number_of_line,
                          fmt::format("must name two columns and their unit, as in x_mm,y_mm, and "
                                      "is \"{}\"",
                                      excerpt(std::string(line))));
        }
        const auto pair = cells(line);
        const auto x = pair ? number(pair->first) : std::nullopt;
        const auto y = pair ? number(pair->second) : std::nullopt;
        if (!x || !y)
            return refuse(number_of_line, fmt::format("must be two finite numbers x,y, and is "
                                                      "\"{}\"",
                                                      excerpt(std::string(line))));
        // Divided where that is exact: 49 / 1000 is the double next to 0.049.
        const double per_m = std::round(1.0 / *unit);
        const Vec2 point = {*x / per_m, *y / per_m};
        if (!file.points_m.empty() && file.points_m.back() == point)
            return refuse(number_of_line, "is where the point before it is");
        if (file.points_m.size() == most_points)
            return refuse(number_of_line, fmt::format("is one point too many: at most {} are "
                                                      "possible",
                                                      most_points));
        file.points_m.push_back(point);
    }
    if (file.points_m.size() < 2)
        file.problem = fmt::format("must hold at least 2 points below a line that names its "
                                   "columns, as in x_mm,y_mm, and holds {}",
                                   file.points_m.size());
    return file;
}

} // namespace shearwake
