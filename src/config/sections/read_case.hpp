// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/reader.hpp"
#include "config/files/files.hpp"
#include "problem/case/case.hpp"
#include "problem/case/optimise_options.hpp"
#include "problem/load/footprint.hpp"

#include <optional>

namespace shearwake::config {

/// Whether [load.modulation] may contain keys that do not apply to its kind.
enum class OtherKinds { refused, ignored };

/// Readers of the parts of a case, one per table.
Medium read_medium(Reader& reader, const MapLoader& load_map);
/// Reads body `number` (counted from 1) of a medium whose layers and map have been read.
Body read_body(Reader reader, std::size_t number, const Medium& medium);
Load read_load(Reader& reader, const Medium& medium, OtherKinds other_kinds,
               const FileLoaders& files);
Domain read_domain(Reader& reader);
/// `load`: null after an error.
TimeAxis read_time(Reader& reader, const Load* load);
SolverOptions read_solver(Reader& reader, const TimeAxis& time);
/// The parts of a case on which its measures depend.
struct Measured {
    const TimeAxis& time;
    const Domain& domain;
    const Load& load;
    const Medium& medium;
    const std::optional<AfferentOptions>& afferents;
};
MeasureOptions read_measure(Reader& reader, const Measured& of);
/// The corners of the measured region. If the keys are absent: none, or in the periodic regime the
/// surroundings of the path, since waves of low frequency fill an infinite plane.
std::vector<Vec2> read_region(Reader& reader, const Measured& of);
RecordOptions read_record(Reader& reader, const Domain& domain, const TimeAxis& time,
                          const MeasureOptions& measure);

/// Reads [optimise]; none if the job has no such table.
std::optional<OptimiseOptions> read_optimise(Reader reader);

/// Reads [vibrometer]; nothing if the table is absent. The points must lie inside the domain of the
/// case, if that has an extent, and the surface must be among its depths.
std::optional<VibrometerOptions> read_vibrometer(Reader& reader, const Case& c,
                                                 const TextLoader& load_text);

/// Reads [afferents]; nothing if the table is absent. The pins must lie inside the domain, if that
/// has an extent. If the job lists no pins, they follow the path or the foci of `load`; without a
/// load (null), there is one pin at the origin.
std::optional<AfferentOptions> read_afferents(Reader& reader, const Domain& domain,
                                              const Load* load, const TextLoader& load_text);

/// The case that the complete job `root` describes; nothing after an error, which is reported.
std::optional<Case> read_case(const NodePtr& root, OtherKinds other_kinds, const FileLoaders& files,
                              DiagnosticList& diagnostics);

/// The tables of a job that define a case.
std::span<const std::string_view> case_tables();

/// Whether a key of [load.modulation] applies to this kind.
bool has_meaning(std::string_view key, std::string_view kind);

/// Density of air at 25 degrees Celsius, where the speed of sound is 346.1 m/s.
inline constexpr double air_density_kg_m3 = 1.184;

/// The presets of arrays as TOML, with their sources as comments.
std::string array_presets();

/// A footprint, and the peak pressure that follows from the strength of the pistons of an array, or
/// from the pressure behind a lens.
struct FootprintAndPeak {
    Footprint footprint;
    bool defines_peak = false;
    std::optional<double> peak_Pa;
};
FootprintAndPeak read_footprint(Reader reader, const FileLoaders& files);

} // namespace shearwake::config
