// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/reader.hpp"
#include "load/footprint.hpp"

#include <optional>

namespace shearwake::config {

/// A footprint, and the peak pressure that follows from the strength of the pistons of an array.
struct FootprintAndPeak {
    Footprint footprint;
    bool gives_peak = false;
    std::optional<double> peak_Pa;
};
FootprintAndPeak read_footprint(Reader reader);

} // namespace shearwake::config
