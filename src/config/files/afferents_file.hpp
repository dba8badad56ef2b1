// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/afferents.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace shearwake::config {

/// The afferents of a CSV file, or the reason why it was rejected.
struct AfferentsFile {
    std::vector<ListedAfferent> afferents;
    std::string problem;
};

/// The first line is "x_mm,y_mm,class,row", followed by one afferent per line: the class is SA1, RA
/// or PC, and the row is the index, from 0, of one of the 4, 9 or 4 neurons of the class. Empty
/// lines and lines that begin with # are ignored. At least one afferent and at most 100 000.
AfferentsFile read_listed_afferents(std::string_view csv);

} // namespace shearwake::config
