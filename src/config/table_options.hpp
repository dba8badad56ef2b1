// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/reader.hpp"
#include "config/sweep/sweep_axes.hpp"
#include "problem/case/plan.hpp"

namespace shearwake::config {

/// [table]: the layout, and the changes that turn a case into its reference.
struct TableSection {
    TableOptions options;
    NodePtr reference; // keys of load.modulation; null: no reference
};

TableSection read_table(Reader reader, const Sweep& sweep);

} // namespace shearwake::config
