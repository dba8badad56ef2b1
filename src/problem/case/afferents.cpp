// SPDX-License-Identifier: BSD-3-Clause
#include "problem/case/afferents.hpp"

namespace shearwake {

std::string name_of(AfferentClass kind) {
    return name_in_text(kind);
}

std::optional<AfferentClass> class_named(const std::string& name) {
    for (const AfferentClass kind : all_classes)
        if (name_of(kind) == name) return kind;
    return std::nullopt;
}

} // namespace shearwake
