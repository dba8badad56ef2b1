// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/reader.hpp"
#include "problem/case/optimise_options.hpp"

#include <optional>

namespace shearwake::config {

/// Reads [optimise]; none if the job has no such table.
std::optional<OptimiseOptions> read_optimise(Reader reader);

} // namespace shearwake::config
