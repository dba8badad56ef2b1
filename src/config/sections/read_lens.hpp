// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/reader.hpp"
#include "config/files/loaders.hpp"
#include "config/sections/read_footprint.hpp"

namespace shearwake::config {

/// A footprint with shape = "lens". Its design is computed, or taken from those of the same job.
FootprintAndPeak read_lens(Reader& reader, const FileLoaders& files);

} // namespace shearwake::config
