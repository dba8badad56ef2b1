// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "measures/surface_sums.hpp"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace shearwake::measures {

// The measures of a case: one entry per column of the table and one per series of the case file.
// Their names, units and descriptions are defined only here. Case files, `reduce` and the
// report use these tables.

/// Where a column is shown in addition to the complete table (CSV).
enum class Shown {
    csv,       // only there
    shapes,    // in the report, if a shape is drawn
    page,      // in the report
    headlines, // in the report and in the short table of `reduce`
};

/// Whether a column has a physical unit (or a ratio of such values), or counts samples of the grid.
enum class Counts { physical, samples };

/// One column. A name with {words} in braces represents several columns. In `meaning`, braces are
/// replaced by details of the case; parts in brackets are omitted if the details are unknown.
struct Measure {
    const char* name;
    const char* unit; // "1", "mm2", "um", "mN ms", "uJ", "Hz", "degree"
    const char* meaning;
    Shown shown = Shown::csv;
    /// For ratios that `reduce` computes: the measure that is divided by that of the reference
    /// case.
    const char* over_reference_of = "";
    /// What the values are relative to: on grids of other spacing, numbers of samples differ.
    Counts counts = Counts::physical;
};

/// All columns, in the order of the report and of the short table.
std::span<const Measure> all_measures();
/// The entry of a column; for "focal_rms_um_z1.5mm", that of "focal_rms_um". Null if there is none.
const Measure* find_measure(std::string_view column);

/// The columns with their units and meanings as a Markdown table.
std::string column_reference();

/// Whether a column is read at one instant, and depends on the phase of the modulation.
bool is_at_instant(std::string_view column);

/// Whether a column counts samples of the grid, so that its values on different grids cannot be
/// compared.
bool counts_samples(std::string_view column);

/// The value of a name in braces, such as {"radius", "3"}.
using Detail = std::pair<std::string_view, std::string>;
/// `text` with its details substituted.
std::string with_details(std::string_view text, std::span<const Detail> details);
struct Column; // measures/summary.hpp
/// The column of a measure, named as in the table of measures, with the details of the case.
Column column_of(std::string_view name, double value, std::span<const Detail> details);

/// One series over time and depth in the case file.
struct FrameMeasure {
    const char* name;
    const char* unit;
    const char* meaning;
    double (*value)(const SurfaceSums&);
};
std::span<const FrameMeasure> frame_measures();

} // namespace shearwake::measures
