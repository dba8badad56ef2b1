#pragma once

#include "model/grid_study.hpp"
#include "parallel/comm.hpp"

#include <filesystem>

namespace shearwake {

/// A study in the HDF5 file that scripts/import-kwave writes (docs/kwave.md has its contents). Not
/// collective. Throws UsageError for whatever is wrong with the file.
GridStudy read_grid_study(const std::filesystem::path& path);

/// The same, read on rank 0 and known to all ranks afterwards; they throw together. Collective.
GridStudy read_grid_study(const std::filesystem::path& path, const Comm& comm);

} // namespace shearwake
