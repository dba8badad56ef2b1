// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/reader.hpp"
#include "config/files/loaders.hpp"
#include "config/sections/read_footprint.hpp"
#include "problem/case/optimise_options.hpp"

#include <optional>

namespace shearwake::config {

/// A footprint with shape = "lens". Its design is computed, or taken from those of the same job.
FootprintAndPeak read_lens(Reader& reader, const FileLoaders& files);

/// Reads [optimise]; none if the job has no such table.
std::optional<OptimiseOptions> read_optimise(Reader reader);

} // namespace shearwake::config
