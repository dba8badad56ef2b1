// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/files/text_loader.hpp"
#include "config/sweep/override.hpp"
#include "problem/case/afferents.hpp"

#include <span>
#include <string>
#include <string_view>

namespace shearwake::config {

/// Reads [afferents] of a job file, or of a file that contains only this table, and overrides of
/// its keys; without both, the defaults. Throws BadJob with all errors.
AfferentOptions read_afferent_options(std::string_view text, const std::string& file_name,
                                      std::span<const Override> overrides,
                                      const TextLoader& load_text);

} // namespace shearwake::config
