#pragma once

#include "reduce/match.hpp"
#include "reduce/read_csv.hpp"
#include "reduce/tolerance.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace shearwake {

/// A cell beyond its tolerance.
struct MovedCell {
    std::string case_name; // row_name
    std::string now, reference;
    /// Of numbers: the change over the reference (over the column's largest where that is 0). NaN
    /// for words and for cells that have become empty or are no longer.
    double change = 0.0;
    double over_tolerance = 0.0; // the change in units of the tolerance; infinite for words
};

struct MovedColumn {
    std::string column;
    Tolerance tolerance;
    std::vector<MovedCell> cells; // worst first
};

struct ComparedColumn {
    std::string column;
    Tolerance tolerance;
};

/// What differs between two tables.
struct Differences {
    std::vector<MovedColumn> moved; // worst first
    std::vector<std::string> missing_cases, extra_cases, missing_columns, extra_columns;
    std::vector<ComparedColumn> compared;
    std::vector<std::string> not_compared;
    std::size_t cases = 0;             // that both tables have
    std::size_t cases_of_other_id = 0; // of them matched by their swept values: no difference

    bool none() const;
};

/// Compares cell by cell: numbers within their tolerance of the reference, words exactly. Throws
/// UsageError when a tolerance names a column that neither table has.
Differences compare(const TextTable& now, const TextTable& reference, const Tolerances& tolerances);

/// For people: what moved and by how much, a column a line, worst first.
std::string words(const Differences& differences);

/// For programs: the same as JSON, with every cell.
std::string json_text(const Differences& differences);

/// The table of an output folder (tables/<job>.csv), or the path itself if it is a file. Throws
/// UsageError (environment) with what to do when there is none.
std::filesystem::path table_in(const std::filesystem::path& path);

} // namespace shearwake
