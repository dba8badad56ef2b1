#pragma once

#include "config/reader.hpp"
#include "config/text_loader.hpp"
#include "model/case.hpp"

#include <optional>

namespace shearwake {

/// Whether [load.modulation] may hold keys that its kind has no use for.
enum class OtherKinds { refused, ignored };

/// The parts of a case, each from its table.
Medium read_medium(Reader& reader, const MapLoader& load_map);
/// The body of a table that stands `number`th (from 1) in a medium whose layers and map are read.
Body read_body(Reader reader, std::size_t number, const Medium& medium);
Load read_load(Reader& reader, const Medium& medium, OtherKinds other_kinds,
               const TextLoader& load_text);
Modulation read_modulation(Reader& reader, const Medium& medium, OtherKinds other_kinds,
                           const TextLoader& load_text);
Domain read_domain(Reader& reader);
TimeAxis read_time(Reader& reader);
SolverOptions read_solver(Reader& reader, const TimeAxis& time, const StudyLoader& load_study);
MeasureOptions read_measure(Reader& reader, const TimeAxis& time, const Load& load,
                            const Medium& medium);
RecordOptions read_record(Reader& reader, const Domain& domain, const TimeAxis& time,
                          const MeasureOptions& measure);

/// The case that the whole job `root` describes; nothing, and findings, if there is a mistake.
std::optional<Case> read_case(const NodePtr& root, OtherKinds other_kinds, const FileLoaders& files,
                              Diagnostics& findings);

/// The tables of a job of which a case is made.
std::span<const std::string_view> case_tables();

/// Whether a key of [load.modulation] has a meaning for this kind.
bool has_meaning(std::string_view key, std::string_view kind);

} // namespace shearwake
