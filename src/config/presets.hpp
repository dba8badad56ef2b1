#pragma once

#include "config/tree.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace shearwake {

/// Every preset that [medium] may name.
std::vector<std::string> preset_names();

/// Those of a single layer, which a [[medium.layer]] may name.
std::vector<std::string> layer_preset_names();

/// The preset as the table that would stand under [medium], every value said to stand at `place`.
/// Null if there is none of that name.
NodePtr medium_preset(std::string_view name, const Place& place);

/// `layer` with the keys it does not give taken from the preset it names, if it names one.
NodePtr with_layer_preset(const NodePtr& layer);

/// Those that a [[medium.body]] may name, and its table with the keys it does not give taken from
/// the one it names, if it names one.
std::vector<std::string> body_preset_names();
NodePtr with_body_preset(const NodePtr& body);

/// `root` with medium.preset replaced by its base and layers. Layers or a base that the job gives
/// stay. An unknown name stays too, for the reader to report.
NodePtr with_medium_preset(const NodePtr& root);

} // namespace shearwake
