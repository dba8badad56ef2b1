#pragma once

#include "model/load.hpp"
#include "model/toml_text.hpp"

namespace shearwake {

/// The load's part of a case's canonical text.
void put_load(TomlText& t, const Load& load);

} // namespace shearwake
