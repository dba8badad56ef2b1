#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake {

/// How far a number may be from its reference.
struct Tolerance {
    double relative = 0.0;          // of the reference
    std::optional<double> absolute; // where the reference is 0; without: `relative` of the largest
                                    // reference in the column
    bool operator==(const Tolerance&) const = default;
};

/// Tolerances by column; those that are not named have the program's own.
struct Tolerances {
    std::map<std::string, Tolerance, std::less<>> named;
    std::optional<Tolerance> others;  // instead of the program's own
    std::vector<std::string> ignored; // besides those of `ignored_column`

    Tolerance of(std::string_view column) const;
    bool ignores(std::string_view column) const;
};

/// The program's own tolerance of a column.
Tolerance default_tolerance(std::string_view column);

/// What belongs to the machine and not to the physics (seconds, hosts), and the words of `note`:
/// what they explain is compared itself.
bool is_never_compared(std::string_view column);

/// A file of tolerances:
///     ignore = ["mach_angle_deg"]
///     [tolerance]
///     eta_at_1 = 1e-5                                   # relative
///     peak_um = { relative = 1e-5, absolute = 1e-9 }
///     "*" = 1e-6                                        # every column that is not named
/// Throws UsageError (usage) with every mistake and its place.
Tolerances read_tolerances(std::string_view text, const std::string& file_name);

/// "COLUMN=REL", as given to --tolerance, into `tolerances`. Throws UsageError.
void add_tolerance(Tolerances& tolerances, const std::string& text);

} // namespace shearwake
