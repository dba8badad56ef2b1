// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "problem/medium/material_map.hpp"

#include <filesystem>

namespace shearwake::storage {

/// Reads a map of properties from an HDF5 file: uniform ascending coordinates x_m, y_m and z_m, and
/// one or more of c_s_m_s, c_p_m_s, density_kg_m3 and viscosity_Pa_s of shape (x, y, z), in any
/// number type, compressed or not. Arrays that MATLAB wrote, recognised by their attributes or
/// their shape, have their indices in reverse. With one point along an axis, properties do not vary
/// along it. Not collective. Throws UsageError for all errors in the file.
MaterialMap read_map_file(const std::filesystem::path& path);

/// Reads on rank 0 and broadcasts to all ranks; errors are thrown on all of them. Collective.
MaterialMap read_map_file(const std::filesystem::path& path, const Comm& comm);

} // namespace shearwake::storage
