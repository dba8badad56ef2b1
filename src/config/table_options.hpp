#pragma once

#include "config/reader.hpp"
#include "config/sweep_axes.hpp"
#include "model/plan.hpp"

namespace shearwake {

/// [table]: the layout, and what turns a case into the one it is compared with.
struct TableSection {
    TableOptions options;
    NodePtr reference; // keys of load.modulation; null: no reference
};

TableSection read_table(Reader reader, const Sweep& sweep);

} // namespace shearwake
