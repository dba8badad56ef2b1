// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "reduce/table.hpp"

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::reduce {

/// Tolerance of a number with respect to its reference.
struct Tolerance {
    double relative = 0.0;          // relative to the reference
    std::optional<double> absolute; // where the reference is 0; without: `relative` of the largest
                                    // reference in the column
    bool operator==(const Tolerance&) const = default;
};

/// Tolerances by column; other columns have the default of the program.
struct Tolerances {
    std::map<std::string, Tolerance, std::less<>> named;
    std::optional<Tolerance> others;  // replaces the default of the program
    std::vector<std::string> ignored; // in addition to those of `ignored_column`

    Tolerance of(std::string_view column) const;
    bool ignores(std::string_view column) const;
};

/// The default tolerance of a column.
Tolerance default_tolerance(std::string_view column);

/// Columns that depend on the machine and not on the physics (seconds, hosts), and `note`, whose
/// causes are compared themselves.
bool is_never_compared(std::string_view column);

/// A file of tolerances:
///     ignore = ["mach_angle_deg"]
///     [tolerance]
///     eta_at_1 = 1e-5                                   # relative
///     peak_um = { relative = 1e-5, absolute = 1e-9 }
///     "*" = 1e-6                                        # every column that is not named
/// Throws UsageError (usage) with all errors and their locations.
Tolerances read_tolerances(std::string_view text, const std::string& file_name);

/// "COLUMN=REL", as given to --tolerance, into `tolerances`. Throws UsageError.
void add_tolerance(Tolerances& tolerances, const std::string& text);

struct RowPair {
    std::size_t now = 0, reference = 0;
};

/// The correspondence between the rows of two tables.
struct Matched {
    std::vector<RowPair> pairs;       // in the order of the reference
    std::vector<std::size_t> extra;   // rows that only `now` has
    std::vector<std::size_t> missing; // rows that only `reference` has
    std::size_t by_settings = 0;      // pairs whose ids differ
};

/// The swept columns: those directly after `id` and `reference` whose names contain a dot.
std::vector<std::size_t> swept_columns(const TextTable& table);

/// Matches rows by id, and the remaining ones by the values of the swept keys that both tables
/// have, if these values are unique in both tables.
Matched match_rows(const TextTable& now, const TextTable& reference);

/// "load.peak_Pa=200, load.modulation.speed_m_s=7", "the reference", or otherwise the id.
std::string row_name(const TextTable& table, std::size_t row);

/// A cell beyond its tolerance.
struct MovedCell {
    std::string case_name; // row_name
    std::string now, reference;
    /// For numbers: the change divided by the reference (by the largest value of the column if that
    /// is 0). NaN for text and for cells that are empty in one of the tables.
    double change = 0.0;
    double over_tolerance = 0.0; // the change in units of the tolerance; infinite for text
};

struct MovedColumn {
    std::string column;
    Tolerance tolerance;
    std::vector<MovedCell> cells; // largest first
};

struct ComparedColumn {
    std::string column;
    Tolerance tolerance;
};

/// The differences between two tables.
struct Differences {
    std::vector<MovedColumn> moved; // largest first
    std::vector<std::string> missing_cases, extra_cases, missing_columns, extra_columns;
    std::vector<ComparedColumn> compared;
    std::vector<std::string> not_compared;
    std::size_t cases = 0; // number of cases that both tables have
    std::size_t cases_of_other_id =
        0; // of these, matched by their swept values, which is not a difference

    bool none() const;
};

/// Compares cell by cell: numbers within their tolerance, text exactly. Throws UsageError when a
/// tolerance names a column that neither table has.
Differences compare(const TextTable& now, const TextTable& reference, const Tolerances& tolerances);

/// As text: the changed columns, one per line, largest change first.
std::string words(const Differences& differences);

/// The document of `diff --json`, with all cells, for the tables with these paths.
std::string json_text(const Differences& differences, const std::filesystem::path& now,
                      const std::filesystem::path& reference);

/// The table of an output folder (tables/<job>.csv), or the path itself if it is a file. Throws
/// UsageError (environment) with a remedy if there is none.
std::filesystem::path table_in(const std::filesystem::path& path);

} // namespace shearwake::reduce
