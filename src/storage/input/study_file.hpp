// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "case/study_data.hpp"
#include "parallel/comm.hpp"

#include <filesystem>

namespace shearwake::storage {

/// Reads a study from the HDF5 file that scripts/import-kwave writes (docs/how-to/kwave.md
/// describes its contents). Not collective. Throws UsageError for all errors in the file.
StudyData read_study_file(const std::filesystem::path& path);

/// Reads on rank 0 and broadcasts to all ranks; errors are thrown on all of them. Collective.
StudyData read_study_file(const std::filesystem::path& path, const Comm& comm);

} // namespace shearwake::storage
