// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

} // namespace shearwake::reduce
