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

/// The unit of the columns in m, according to their names.
std::optional<double> unit_m(const std::vector<std::string>& names) {
    if (names.size() != 2 || without_unit(names[0]) != "x" || without_unit(names[1]) != "y")
        return std::nullopt;
    const auto x = unit_of(names[0]), y = unit_of(names[1]);
    if (!x || !y || x->suffix != y->suffix || x->quantity != "length") return std::nullopt;
    return x->to_SI;
}

} // namespace

PointsFile read_points(std::string_view csv) {
    PointsFile file;
    std::optional<double> unit;
    CsvReader reader(csv, CsvText::relaxed);
    const auto refuse = [&](std::size_t line, std::string_view what) {
        return PointsFile{{}, fmt::format("line {}: {}", line, what)};
    };
    while (true) {
        try {
            if (!reader.next()) break;
        } catch (const CsvError& error) {
            return refuse(error.line, fmt::format("has {}", error.what()));
        }
        const auto& cells = reader.cells();
        if (!unit) {
            unit = unit_m(cells);
            if (unit) continue;
            return refuse(
                reader.line(),
                fmt::format("must name two columns and their unit, as in x_mm,y_mm, but is \"{}\"",
                            excerpt(reader.text())));
        }
        const auto x = cells.size() == 2 ? finite_number_in(cells[0]) : std::nullopt;
        const auto y = cells.size() == 2 ? finite_number_in(cells[1]) : std::nullopt;
        if (!x || !y)
            return refuse(reader.line(),
                          fmt::format("must be two finite numbers x,y, but is \"{}\"",
                                      excerpt(reader.text())));
        // Division is exact here: 49 / 1000 is the double closest to 0.049.
        const double per_m = std::round(1.0 / *unit);
        const Vec2 point = {*x / per_m, *y / per_m};
        if (!file.points_m.empty() && file.points_m.back() == point)
            return refuse(reader.line(), "repeats the previous point");
        if (file.points_m.size() == most_points)
            return refuse(reader.line(),
                          fmt::format("exceeds the limit of {} points", most_points));
        file.points_m.push_back(point);
    }
    if (file.points_m.size() < 2)
        file.problem = fmt::format("must contain at least 2 points below a header that names its "
                                   "columns, as in x_mm,y_mm, but contains {}",
                                   file.points_m.size());
    return file;
}

} // namespace shearwake::config
