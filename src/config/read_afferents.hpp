#pragma once

#include "config/reader.hpp"
#include "config/text_loader.hpp"
#include "model/case.hpp"

#include <optional>

namespace shearwake {

/// [afferents]; nothing if it is not there. Its pins must lie in the domain, if that has an extent.
std::optional<AfferentOptions> read_afferents(Reader& reader, const Domain& domain,
                                              const TextLoader& load_text);

} // namespace shearwake
