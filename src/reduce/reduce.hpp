// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "reduce/table.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace shearwake::reduce {

/// Whether the CSV and Markdown tables have columns with the errors of `shearwake converge`.
/// `as_before`: if the existing table has them.
enum class ErrorColumns { omitted, added, as_before };

/// The last columns of every table: valid, wall_s, status, note.
inline constexpr std::size_t closing_columns = 4;

/// The location of the files of a sweep and of its tables.
struct ReduceInput {
    std::filesystem::path folder, plan, tables; // `folder` contains the journals and the case files
    /// converge.json. The JSON table always has its errors. Empty or missing: no errors.
    std::filesystem::path errors = {};
    std::string meaning_of_errors = "estimated numerical error";
    ErrorColumns error_columns = ErrorColumns::omitted;
};

struct ReducedTables {
    std::filesystem::path csv, markdown;
    std::filesystem::path statistics, sensitivity; // of [uncertain]; empty: not written
    std::filesystem::path adaptive;                // of adaptive axes; empty: not written
    std::string first_rows;                        // of the main columns, for the terminal
    std::size_t rows = 0;
    std::size_t complete = 0;
    std::size_t points_to_add = 0;     // of adaptive axes, according to the complete cases
    std::size_t not_valid = 0;         // complete cases whose readings are not valid
    std::vector<std::string> damaged;  // ids
    std::vector<std::string> programs; // git ids of the programs that computed the complete cases
};

/// One row per case, in the order of the plan, references last: id, all swept keys, all measures,
/// ratios to the reference case, valid (yes or no: whether the readings may be used; empty without
/// a complete file), wall_s, status (complete, failed, damaged, missing) and note (the reason for a
/// failure or for empty cells). Verifies the checksums of all case files. Only reads files; not
/// collective.
Table table_of(const ReduceInput& input);

/// Writes the table as CSV, Markdown and JSON. Throws UsageError (environment) when it cannot, or
/// when error columns are requested and there are no errors.
ReducedTables reduce(const ReduceInput& input);

} // namespace shearwake::reduce
