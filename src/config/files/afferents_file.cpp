// SPDX-License-Identifier: BSD-3-Clause
#include "config/files/afferents_file.hpp"

#include "base/csv.hpp"
#include "config/document/diagnostic.hpp"

#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace shearwake::config {
namespace {

constexpr std::size_t most_afferents = 100'000;
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

} // namespace

AfferentsFile read_listed_afferents(std::string_view csv) {
    AfferentsFile file;
    bool has_heading = false;
    const auto refuse = [](std::size_t line, std::string_view what) {
        return AfferentsFile{{}, fmt::format("line {}: {}", line, what)};
    };
    CsvReader reader(csv);
    while (true) {
        try {
            if (!reader.next()) break;
        } catch (const CsvError& error) {
            return refuse(error.line, fmt::format("has {}", error.what()));
        }
        if (!has_heading) {
            if (fmt::format("{}", fmt::join(reader.cells(), ",")) != heading)
                return refuse(reader.line(), fmt::format("must be the header {}, but is \"{}\"",
                                                         heading, excerpt(reader.text())));
            has_heading = true;
            continue;
        }
        const auto one = afferent(reader.cells());
        if (!one)
            return refuse(reader.line(), fmt::format("must be {}, {}, but is \"{}\"", heading,
                                                     rows_text(), excerpt(reader.text())));
        if (file.afferents.size() == most_afferents)
            return refuse(reader.line(),
                          fmt::format("exceeds the limit of {} afferents", most_afferents));
        file.afferents.push_back(*one);
    }
    if (file.afferents.empty())
        file.problem =
            fmt::format("must contain at least one afferent below the header {}", heading);
    return file;
}

} // namespace shearwake::config
