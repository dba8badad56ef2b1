#pragma once

#include "config/reader.hpp"
#include "config/text_loader.hpp"
#include "model/medium.hpp"
#include "model/trajectory.hpp"

namespace shearwake {

/// What readers of paths need to know besides their table.
struct PathContext {
    const Medium& medium; // Mach numbers are in its first c_s
    const TextLoader& load_text;
};

/// Whether a path may be a point.
enum class LeastLength { some, none };

/// A path and what happens at its end: closed ones are repeated, others go out, if it is not said.
/// Something harmless after a mistake.
struct PathAndEnd {
    Curve path;
    AtEnd at_end = AtEnd::off;
    bool end_is_given = false;
};
PathAndEnd read_path(Reader reader, const PathContext& context,
                     LeastLength least = LeastLength::some);

enum class SpeedKind { constant, oscillating, either };
/// The keys path, speed_m_s, mach, draw_frequency_Hz, corner_..., and speed_deviation_m_s,
/// sm_frequency_Hz, sm_phase_deg of a table.
Travel read_travel(Reader& reader, const PathContext& context, SpeedKind speed);

/// A whole number; the least one after a mistake.
int read_count(Reader& reader, std::string_view key, const Range& range);

} // namespace shearwake
