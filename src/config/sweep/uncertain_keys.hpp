// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/reader.hpp"
#include "config/files/text_loader.hpp"
#include "sampling/distribution.hpp"

#include <optional>
#include <string>
#include <vector>

namespace shearwake::config {

/// Reads the distribution of the key `key`, in the unit of the key. Nothing after an error.
std::optional<sampling::Distribution> read_distribution(Reader reader, const std::string& key,
                                                        const FileLoaders& files);

/// The names of the published distributions.
std::vector<std::string> distribution_preset_names();

} // namespace shearwake::config
