// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "storage/checksum/file_checksum.hpp"

#include <filesystem>
#include <functional>
#include <vector>

namespace shearwake::storage {

struct VerifyProgress {
    std::size_t files = 0, all_files = 0;
    double bytes = 0.0, all_bytes = 0.0;
};

/// The result of check_integrity() for one file; `unreadable`: the reason why it could not be read.
struct VerifiedFile {
    IntegrityCheck check;
    std::string unreadable;
};

/// Checks the files with a few threads. `report` is called after each file, by one thread at a
/// time. Not collective.
std::vector<VerifiedFile> verify_files(const std::vector<std::filesystem::path>& files,
                                       const std::function<void(const VerifyProgress&)>& report);

} // namespace shearwake::storage
