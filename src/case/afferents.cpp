// SPDX-License-Identifier: BSD-3-Clause
#include "case/afferents.hpp"

namespace shearwake {

std::string name_of(AfferentClass kind) {
    return name_in_text(kind);
}

std::optional<AfferentClass> class_named(const std::string& name) {
    for (const AfferentClass kind : all_classes)
        if (name_of(kind) == name) return kind;
    return std::nullopt;
}

double receptor_depth_m(AfferentClass kind) {
    return kind == AfferentClass::SA1 ? 0.3e-3 : kind == AfferentClass::RA ? 1.6e-3 : 2e-3;
}

std::size_t neuron_count(AfferentClass kind) {
    return kind == AfferentClass::RA ? 9 : 4;
}

} // namespace shearwake
