// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/reader.hpp"
#include "config/files/loaders.hpp"
#include "problem/case/case.hpp"

#include <optional>

namespace shearwake::config {

/// Reads [vibrometer]; nothing if the table is absent. The points must lie inside the domain of the
/// case, if that has an extent, and the surface must be among its depths.
std::optional<VibrometerOptions> read_vibrometer(Reader& reader, const Case& c,
                                                 const TextLoader& load_text);

} // namespace shearwake::config
