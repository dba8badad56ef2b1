#pragma once

#include "config/reader.hpp"
#include "model/footprint.hpp"

#include <optional>

namespace shearwake {

/// A footprint, and the peak that the strength of an array's pistons makes.
struct FootprintAndPeak {
    Footprint footprint;
    bool gives_peak = false;
    std::optional<double> peak_Pa;
};
FootprintAndPeak read_footprint(Reader reader);

} // namespace shearwake
