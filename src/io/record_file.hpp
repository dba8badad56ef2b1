#pragma once

#include "model/record.hpp"

#include <filesystem>
#include <vector>

namespace shearwake {

/// Groups of variables in an HDF5 file of their own that xarray opens, whole or not at all. Not
/// collective. Throws Error when it cannot be written.
void write_record(const std::filesystem::path& path, const std::vector<VariableGroup>& groups,
                  const std::vector<Attribute>& attributes);

} // namespace shearwake
