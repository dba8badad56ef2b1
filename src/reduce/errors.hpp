// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "reduce/table.hpp"

#include <filesystem>
#include <map>
#include <string>

namespace shearwake::reduce {

/// Case id -> column -> estimated numerical error, in the unit of the column.
using Errors = std::map<std::string, std::map<std::string, double>>;

/// The errors in a converge.json; none if there is no such file. Throws UsageError (environment) if
/// it is not valid. Not collective.
Errors read_errors(const std::filesystem::path& path);

/// The name of the column with the error of a column: "eta_at_1_error".
std::string error_column(const std::string& column);
/// The column whose error a column contains; empty if it contains none.
std::string column_of_error(const std::string& name);

/// The table with a column `<column>_error` after each of the `names` for which a case has an
/// error. Cases without an estimate have empty cells. The column `id` identifies the cases.
Table with_errors(const Table& table, const std::vector<std::string>& names, const Errors& errors);

} // namespace shearwake::reduce
