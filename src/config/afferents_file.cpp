#include "config/afferents_file.hpp"

#include "base/text.hpp"
#include "config/finding.hpp"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace shearwake {
namespace {

constexpr std::size_t most_afferents = 100'000;
constexpr std::string_view heading = "x_mm,y_mm,class,row";

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::vector<std::string_view> cells_of(std::string_view line) {
    std::vector<std::string_view> cells;
    while (true) {
        const std::size_t comma = line.find(',');
        cells.push_back(trimmed(line.substr(0, comma)));
        if (comma == std::string_view::npos) return cells;
        line.remove_prefix(comma + 1);
    }
}

std::optional<double> number(std::string_view text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_whole = error == std::errc() && end == text.data() + text.size();
    return is_whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<ListedAfferent> afferent(std::string_view line) {
    const auto cells = cells_of(line);
    if (cells.size() != 4) return std::nullopt;
    const auto x_mm = number(cells[0]), y_mm = number(cells[1]), row = number(cells[3]);
    const auto kind = class_named(std::string(cells[2]));
    if (!x_mm || !y_mm || !row || !kind || *row != std::floor(*row) || *row < 0.0 ||
        *row >= static_cast<double>(neuron_count(*kind)))
        return std::nullopt;
    return ListedAfferent{{*x_mm / 1000.0, *y_mm / 1000.0}, *kind, static_cast<std::size_t>(*row)};
}

std::string joined(const std::vector<std::string_view>& cells) {
    std::string all;
    for (const std::string_view cell : cells)
        all += (all.empty() ? "" : ",") + std::string(cell);
    return all;
}

} // namespace

AfferentsFile read_listed_afferents(std::string_view csv) {
    AfferentsFile file;
    bool has_heading = false;
    const auto refuse = [](std::size_t line, std::string_view what) {
        return AfferentsFile{{}, fmt::format("line {}: {}", line, what)};
    };
    for (std::size_t number_of_line = 1; !csv.empty(); ++number_of_line) {
        const std::size_t end = std::min(csv.find('\n'), csv.size());
        const std::string_view line = trimmed(csv.substr(0, end));
        csv.remove_prefix(std::min(end + 1, csv.size()));
        if (line.empty() || line.front() == '#') continue;
        if (!has_heading) {
            if (joined(cells_of(line)) != heading)
                return refuse(number_of_line, fmt::format("must be the heading {}, and is \"{}\"",
                                                          heading, excerpt(std::string(line))));
            has_heading = true;
            continue;
        }
        const auto one = afferent(line);
        if (!one)
            return refuse(number_of_line,
                          fmt::format("must be two finite numbers, SA1, RA or PC, and a row from 0 "
                                      "to 3, 8 or 3, and is \"{}\"",
                                      excerpt(std::string(line))));
        if (file.afferents.size() == most_afferents)
            return refuse(number_of_line, fmt::format("is one afferent too many: at most {} are "
                                                      "possible",
                                                      most_afferents));
        file.afferents.push_back(*one);
    }
    if (file.afferents.empty())
        file.problem = fmt::format("must hold an afferent below the heading {}", heading);
    return file;
}

} // namespace shearwake
