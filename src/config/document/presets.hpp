// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/tree.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace shearwake::config {

/// All presets of media and bodies as TOML, with their sources as comments.
std::string layer_and_body_presets();

/// All presets for [medium].
std::vector<std::string> preset_names();

/// The presets of a single layer, for [[medium.layer]].
std::vector<std::string> layer_preset_names();

/// The preset as a [medium] table, with `place` as the location of every value. Null if there is no
/// preset of that name.
NodePtr medium_preset(std::string_view name, const Place& place);

/// `layer`, with missing keys supplied by the preset that it names, if any.
NodePtr with_layer_preset(const NodePtr& layer);

/// The presets for [[medium.body]], and its table with missing keys supplied by the preset that it
/// names, if any.
std::vector<std::string> body_preset_names();
NodePtr with_body_preset(const NodePtr& body);

/// `root` with medium.preset replaced by its base and layers. A base or layers that the job gives
/// are not replaced. An unknown name is left in place and reported by the reader; the most similar
/// preset supplies the layers.
NodePtr with_medium_preset(const NodePtr& root);

/// How to request what a user may have meant by the value 0 of a key that must not be 0; empty if
/// nothing is known. `kind`: that of the same table, or empty. A sentence without a capital letter
/// and a full stop.
std::string_view instead_of_zero(std::string_view key, std::string_view kind);

} // namespace shearwake::config
