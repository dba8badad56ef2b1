// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/errors.hpp"

#include "base/constants.hpp"
#include "base/error.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace shearwake::reduce {
namespace {

constexpr std::string_view suffix = "_error";

} // namespace

Errors read_errors(const std::filesystem::path& path) {
    Errors errors;
    if (!std::filesystem::exists(path)) return errors;
    try {
        const auto root = nlohmann::json::parse(storage::read_file(path));
        for (const auto& c : root.at("cases")) {
            auto& found = errors[c.at("id").get<std::string>()];
            for (const auto& [column, entry] : c.at("columns").items())
                if (entry.at("error").is_number()) found[column] = entry.at("error").get<double>();
        }
    } catch (const nlohmann::json::exception& error) {
        throw UsageError(fmt::format("{} is not a result of shearwake converge: {}; rerun "
                                     "shearwake converge",
                                     path.string(), error.what()),
                         ExitCode::environment);
    }
    return errors;
}

std::string error_column(const std::string& column) {
    return column + std::string(suffix);
}

std::string column_of_error(const std::string& name) {
    return name.ends_with(suffix) ? name.substr(0, name.size() - suffix.size()) : "";
}

Table with_errors(const Table& table, const std::vector<std::string>& names, const Errors& errors) {
    const auto has_errors = [&](const std::string& name) {
        return std::ranges::find(names, name) != names.end() &&
               std::ranges::any_of(errors, [&](const auto& c) { return c.second.contains(name); });
    };
    Table extended;
    extended.remarks = table.remarks;
    extended.rows.resize(table.rows.size());
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        const std::string& name = table.columns[i];
        const bool extends = has_errors(name);
        extended.columns.push_back(name);
        if (extends) extended.columns.push_back(error_column(name));
        for (std::size_t row = 0; row < table.rows.size(); ++row) {
            extended.rows[row].push_back(table.rows[row][i]);
            if (!extends) continue;
            const auto found = errors.find(std::get<std::string>(table.rows[row][0]));
            const bool known = found != errors.end() && found->second.contains(name);
            extended.rows[row].emplace_back(known ? found->second.at(name) : not_a_number);
        }
    }
    return extended;
}

} // namespace shearwake::reduce
