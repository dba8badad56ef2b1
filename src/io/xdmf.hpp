#pragma once

#include "io/case_file_writer.hpp"

#include <filesystem>

namespace shearwake {

/// `<case>.xdmf` beside a case file that keeps frames: ParaView opens u_z(x, y) over time with it.
/// Not collective.
void write_xdmf(const std::filesystem::path& case_file, const SurfaceLayout& layout);

/// `<case>.volume.xdmf` beside a case file that keeps volumes: ParaView opens each component over
/// (x, y, z) and time with it. Not collective.
void write_volume_xdmf(const std::filesystem::path& case_file, const VolumeLayout& layout);

} // namespace shearwake
