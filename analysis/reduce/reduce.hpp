#pragma once

#include "reduce/table.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace shearwake {

/// Where a sweep's files are, and where its tables go.
struct ReduceInput {
    std::filesystem::path folder, plan, tables; // `folder` holds the journals and the case files
};

struct ReducedTables {
    std::filesystem::path csv, markdown;
    std::size_t rows = 0;
    std::size_t whole = 0;
    std::vector<std::string> programs; // their git ids, of the whole cases
};

/// One row a case, in the plan's order, references last: id, every swept key, every measure, its
/// ratios to the reference case, wall_s, status (complete, failed, damaged, missing) and note (the
/// reason of a failure or of empty cells). Reads only the files; not collective.
Table table_of(const ReduceInput& input);

/// Writes the table as CSV and Markdown. Throws UsageError (environment) when it cannot.
ReducedTables reduce(const ReduceInput& input);

} // namespace shearwake
