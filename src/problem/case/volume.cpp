// SPDX-License-Identifier: BSD-3-Clause
#include "problem/case/volume.hpp"

namespace shearwake {

std::string name_of(VolumeField field) {
    return name_in_text(field);
}

std::string units_of(VolumeField field) {
    switch (field) {
    case VolumeField::u:
        return "m";
    case VolumeField::strain:
        return "1";
    case VolumeField::stress:
        return "Pa";
    }
    return {};
}

std::vector<std::string> components_of(VolumeField field) {
    if (field == VolumeField::u) return {"x", "y", "z"};
    return {"xx", "yy", "zz", "yz", "xz", "xy"};
}

} // namespace shearwake
