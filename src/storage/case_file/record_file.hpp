// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/record.hpp"

#include <filesystem>
#include <vector>

namespace shearwake::storage {

/// Writes groups of variables to a separate HDF5 file that xarray can open; the file is complete or
/// absent. Not collective. Throws Error if it cannot be written.
void write_record(const std::filesystem::path& path, const std::vector<VariableGroup>& groups,
                  const std::vector<Attribute>& attributes);

} // namespace shearwake::storage
