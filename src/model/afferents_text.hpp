#pragma once

#include "model/afferents.hpp"
#include "model/toml_text.hpp"

namespace shearwake {

/// The afferents' part of a case's canonical text.
void put_afferents(TomlText& t, const AfferentOptions& options);

} // namespace shearwake
