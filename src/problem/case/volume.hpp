// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace shearwake {

/// A field that a case may store over the whole volume: displacement [m], strain (components of the
/// tensor), stress [Pa].
enum class VolumeField { u, strain, stress };
constexpr auto names_of(std::type_identity<VolumeField>) {
    return std::array{"u", "strain", "stress"};
}

/// Its name in job files and case files.
std::string name_of(VolumeField field);
std::string units_of(VolumeField field);

/// x, y, z for the displacement; xx, yy, zz, yz, xz, xy for strain and stress. z points into the
/// tissue.
std::vector<std::string> components_of(VolumeField field);

} // namespace shearwake
