// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "studies/converge/refined_plan.hpp"

#include <map>
#include <string>
#include <vector>

namespace shearwake::converge {

/// Column -> value of one case; NaN: empty.
using Values = std::map<std::string, double>;

/// How one column of one case changes.
struct ColumnChange {
    std::string column;
    double value = 0.0;
    std::vector<double> changes; // per refinement, refined minus unrefined; NaN: not computed
    double error = 0.0;          // 1.5 times the sum of the estimated errors; NaN: unknown
};

struct CaseChange {
    const StudiedCase* studied = nullptr;
    std::vector<ColumnChange> columns; // in alphabetical order
    bool is_complete = false;          // all refinements have results
    bool is_valid = true;              // no stored warning rules the readings out
};

/// Compares the refined cases with the unrefined ones. Columns that count samples do not converge,
/// and the changes of a largest sample do not show what lies between samples: both are omitted.
/// `values` maps ids to the values of complete cases. Not collective.
std::vector<CaseChange> changes_of(const RefinedPlan& refined,
                                   const std::map<std::string, Values>& values);

/// As JSON, schema 1 (docs/reference/results.md): refinements with their orders, changes, errors.
std::string json_text(const std::string& job, const std::vector<CaseChange>& changes);

/// As Markdown, one table per case with the columns of `shown`.
std::string markdown_text(const std::vector<CaseChange>& changes,
                          const std::vector<std::string>& shown);

} // namespace shearwake::converge
