// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "storage/case_file/case_file_writer.hpp"

#include <filesystem>

namespace shearwake::storage {

/// Writes `<case>.xdmf` next to a case file with frames, so that ParaView can open u_z(x, y) over
/// time. Not collective.
void write_xdmf(const std::filesystem::path& case_file, const SurfaceLayout& layout);

/// Writes `<case>.volume.xdmf` next to a case file with volumes, so that ParaView can open each
/// component over (x, y, z) and time. Not collective.
void write_volume_xdmf(const std::filesystem::path& case_file, const VolumeLayout& layout);

} // namespace shearwake::storage
