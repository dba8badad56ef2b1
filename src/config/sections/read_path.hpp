// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/reader.hpp"
#include "config/files/files.hpp"
#include "problem/load/load.hpp"
#include "problem/medium/medium.hpp"

#include <optional>

namespace shearwake::config {

/// Context of the readers of paths, in addition to their table.
struct PathContext {
    const Medium& medium; // Mach numbers refer to c_s of its first layer
    const TextLoader& load_text;
};

/// Whether a path may be a point.
enum class LeastLength { some, none };

/// Reads a path and its behaviour at the end: by default, closed paths repeat and the focus is
/// switched off at the end of open paths. A valid substitute after an error.
struct PathAndEnd {
    Curve path;
    AtEnd at_end = AtEnd::off;
    bool end_is_given = false;
    std::optional<Rests> rests; // of a file that states the time at each point
};
PathAndEnd read_path(Reader reader, const PathContext& context,
                     LeastLength least = LeastLength::some);

/// What a device plays from the file of kind "file": a path, an envelope, or phases of the array.
void read_played(Reader& reader, const PathContext& context, Footprint& footprint,
                 Modulation& modulation);

enum class SpeedKind { constant, oscillating, either };
/// The keys path, speed_m_s, mach, draw_frequency_Hz, corner_..., and speed_deviation_m_s,
/// sm_frequency_Hz, sm_phase_deg of a table.
Travel read_travel(Reader& reader, const PathContext& context, SpeedKind speed);

} // namespace shearwake::config
