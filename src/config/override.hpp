#pragma once

#include "config/tree.hpp"

#include <string>

namespace shearwake {

/// -S key=value. The value is TOML; a bare word that is none is taken as a string.
struct Override {
    std::string key;
    std::string value;
};

/// `root`, whose [sweep] is flattened, with the override in its place; `root` itself and a finding
/// after a mistake.
NodePtr with_override(const NodePtr& root, const Override& override, Diagnostics& findings);

} // namespace shearwake
