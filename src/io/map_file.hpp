#pragma once

#include "model/material_map.hpp"
#include "parallel/comm.hpp"

#include <filesystem>

namespace shearwake {

/// A map of properties in an HDF5 file: regular ascending coordinates x_m, y_m and z_m, and one or
/// more of c_s_m_s, c_p_m_s, density_kg_m3 and viscosity_Pa_s of shape (x, y, z); any number type,
/// compressed or not. One point along an axis: nothing changes along it. Not collective. Throws
/// UsageError for whatever is wrong with the file.
MaterialMap read_map_file(const std::filesystem::path& path);

/// The same, read on rank 0 and known to all ranks afterwards; they throw together. Collective.
MaterialMap read_map_file(const std::filesystem::path& path, const Comm& comm);

} // namespace shearwake
