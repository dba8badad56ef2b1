// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "storage/case_file/case_file_writer.hpp"

#include <filesystem>

namespace shearwake::storage {

/// Writes `<case>.xdmf` next to a case file with frames, so that ParaView can open u_z [m] over
/// (x, y, depth) [m] and time [s]. Not collective.
void write_xdmf(const std::filesystem::path& case_file, const SurfaceLayout& layout);

/// Writes `<case>.volume.xdmf` next to a case file with volumes, so that ParaView can open each
/// component, and the displacement as a vector, over (x, y, z) [m] and time [s]. Not collective.
void write_volume_xdmf(const std::filesystem::path& case_file, const VolumeLayout& layout);

} // namespace shearwake::storage
