#pragma once

#include "io/case_file_writer.hpp"

#include <filesystem>

namespace shearwake {

/// `<case>.xdmf` beside a case file that keeps frames: ParaView opens u_z(x, y) over time with it.
/// Not collective.
void write_xdmf(const std::filesystem::path& case_file, const SurfaceLayout& layout);

} // namespace shearwake
