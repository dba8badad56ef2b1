#include "model/volume.hpp"

namespace shearwake {

std::string name_of(VolumeField field) {
    switch (field) {
    case VolumeField::u:
        return "u";
    case VolumeField::strain:
        return "strain";
    case VolumeField::stress:
        return "stress";
    }
    return {};
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
