// SPDX-License-Identifier: BSD-3-Clause
#include "config/sweep/listed_cases.hpp"

#include "base/csv.hpp"
#include "config/sweep/axis_values.hpp"

#include <fmt/format.h>

namespace shearwake::config {
namespace {

/// A number, true, false or a word.
NodePtr value_in(std::string_view cell, const Place& at) {
    if (const auto number = finite_number_in(cell)) return make_node(*number, at);
    if (cell == "true" || cell == "false") return make_node(cell == "true", at);
    return make_node(std::string(cell), at);
}

/// The axis of a file, or the reason why it was rejected.
struct Listed {
    Axis axis;
    std::string problem;
};

std::string bad_cell(const CsvReader& reader, const Axis& axis) {
    const auto& cells = reader.cells();
    if (cells.size() != axis.keys.size())
        return fmt::format("has {} values, but the first line names {} keys", cells.size(),
                           axis.keys.size());
    for (std::size_t k = 0; k < cells.size(); ++k)
        if (cells[k].empty() || (number_in(cells[k]) && !finite_number_in(cells[k])))
            return fmt::format("the value of {} is \"{}\"; a number or a word is required",
                               axis.keys[k].key, excerpt(cells[k]));
    return "";
}

Listed read_cases(std::string_view csv, const Place& at, DiagnosticList& diagnostics) {
    Listed listed;
    CsvReader reader(csv, CsvText::relaxed);
    const auto refuse = [&](std::size_t line, const std::string& what) {
        return Listed{{}, fmt::format("line {}: {}", line, what)};
    };
    try {
        while (reader.next()) {
            if (listed.axis.keys.empty()) {
                for (const std::string& key : reader.cells()) {
                    const auto path = case_path({key, at, nullptr}, "sweep.list", diagnostics);
                    listed.axis.keys.push_back({key, path.value_or(Path{}), at, {}});
                }
                continue;
            }
            if (const std::string problem = bad_cell(reader, listed.axis); !problem.empty())
                return refuse(reader.line(), problem);
            if (listed.axis.size() == most_cases)
                return refuse(reader.line(),
                              fmt::format("exceeds the limit of {} cases", most_cases));
            for (std::size_t k = 0; k < listed.axis.keys.size(); ++k)
                listed.axis.keys[k].values.push_back(value_in(reader.cells()[k], at));
        }
    } catch (const CsvError& error) {
        return refuse(error.line, fmt::format("has {}", error.what()));
    }
    if (listed.axis.keys.empty() || listed.axis.size() == 0)
        listed.problem = "must contain a line of full keys and a line of values per case";
    return listed;
}

} // namespace

void add_listed_cases(const NodePtr& sweep_node, Sweep& sweep, const FileLoaders& files,
                      DiagnosticList& diagnostics) {
    const auto* table = sweep_node ? std::get_if<TableNode>(&sweep_node->value) : nullptr;
    const Entry* entry = table ? table->find("list") : nullptr;
    if (!entry) return;
    const std::size_t before = diagnostics.errors();
    const Place& at = entry->value->at;
    const auto* file = std::get_if<std::string>(&entry->value->value);
    if (!file || !files.load_text) {
        diagnostics.error(at, file ? "sweep.list: the file cannot be read here"
                                   : "sweep.list must be the path of a CSV file with one case per "
                                     "line");
        sweep.sound = false;
        return;
    }
    Listed listed = read_cases(files.load_text(*file), at, diagnostics);
    if (!listed.problem.empty())
        diagnostics.error(at, fmt::format("sweep.list: {} {}", excerpt(*file), listed.problem));
    for (const SweptKey& key : listed.axis.keys)
        if (sweep.holds(key.key))
            diagnostics.error(at, fmt::format("sweep: {} is swept twice", key.key));
    sweep.sound = sweep.sound && diagnostics.errors() == before;
    if (sweep.sound) sweep.axes.push_back(std::move(listed.axis));
    check_sweep(sweep, diagnostics);
}

} // namespace shearwake::config
