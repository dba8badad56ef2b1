#pragma once

#include "config/override.hpp"
#include "config/text_loader.hpp"
#include "model/afferents.hpp"

#include <span>
#include <string>
#include <string_view>

namespace shearwake {

/// [afferents] of a job file, or of a file that holds nothing else, and overrides of its keys;
/// without either, its defaults. Throws BadJob with every mistake.
AfferentOptions read_afferent_options(std::string_view text, const std::string& file_name,
                                      std::span<const Override> overrides,
                                      const TextLoader& load_text);

} // namespace shearwake
