#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace shearwake {

/// A field that a case may keep over the whole volume: displacement [m], strain (the tensor's
/// components), stress [Pa].
enum class VolumeField { u, strain, stress };

/// As job files and case files spell it.
std::string name_of(VolumeField field);
std::string units_of(VolumeField field);

/// x, y, z for the displacement; xx, yy, zz, yz, xz, xy for strain and stress. z points into the
/// tissue.
std::vector<std::string> components_of(VolumeField field);

} // namespace shearwake
