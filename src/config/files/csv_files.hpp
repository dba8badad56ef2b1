// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/csv.hpp"
#include "base/vectors.hpp"
#include "problem/case/afferents.hpp"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::config {

/// Reads the rows of a CSV text until `problem_of` states why one of them is rejected. Returns that
/// reason, or what is wrong with the text, with the number of the line; empty if there is none.
std::string first_problem(std::string_view csv,
                          const std::function<std::string(const CsvReader& row)>& problem_of);

/// The afferents of a CSV file, or the reason why it was rejected.
struct AfferentsFile {
    std::vector<ListedAfferent> afferents;
    std::string problem;
};

/// The first line is "x_mm,y_mm,class,row", followed by one afferent per line: the class is SA1, RA
/// or PC, and the row is the index, from 0, of one of the 4, 9 or 4 neurons of the class. Empty
/// lines and lines that begin with # are ignored. At least one afferent and at most 100 000.
AfferentsFile read_listed_afferents(std::string_view csv);

/// The points of a CSV file, or the reason why it was rejected.
struct PointsFile {
    std::vector<Vec2> points_m;
    std::vector<double> rests_s; // at each point; empty: the file states none
    std::vector<double> levels;  // at each point, 0 to 1; empty: the file states none
    std::string problem;
};

/// The first line names the columns with their unit, such as "x_mm,y_mm", followed by one point per
/// line; empty lines and lines that begin with # are ignored. At least 2 points and at most 100
/// 000, all finite and each different from the previous one. With `Columns::rests`, it may have a
/// column dwell_ms with the rest at each point, or t_ms with the time at which each rest begins,
/// from 0 on, and level; the last rest then lasts as long as the one before it, and points may be
/// equal.
enum class Columns { places, rests };
PointsFile read_points(std::string_view csv, Columns columns = Columns::places);

} // namespace shearwake::config
