#pragma once

#include "model/afferents.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace shearwake {

/// Afferents out of a CSV file, or why there are none.
struct AfferentsFile {
    std::vector<ListedAfferent> afferents;
    std::string problem;
};

/// The first line is "x_mm,y_mm,class,row", then one afferent a line: SA1, RA or PC, and which of
/// the 4, 9 or 4 neurons of its class, from 0 on. Empty lines and those that begin with # are
/// passed over. At least one afferent and at most 100 000.
AfferentsFile read_listed_afferents(std::string_view csv);

} // namespace shearwake
