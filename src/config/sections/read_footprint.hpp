// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/reader.hpp"
#include "config/files/loaders.hpp"
#include "problem/load/footprint.hpp"

#include <optional>

namespace shearwake::config {

/// Density of air at 25 degrees Celsius, where the speed of sound is 346.1 m/s.
inline constexpr double air_density_kg_m3 = 1.184;

/// The presets of arrays as TOML, with their sources as comments.
std::string array_presets();

/// A footprint, and the peak pressure that follows from the strength of the pistons of an array, or
/// from the pressure behind a lens.
struct FootprintAndPeak {
    Footprint footprint;
    bool gives_peak = false;
    std::optional<double> peak_Pa;
};
FootprintAndPeak read_footprint(Reader reader, const FileLoaders& files);

} // namespace shearwake::config
