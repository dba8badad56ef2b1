// SPDX-License-Identifier: BSD-3-Clause
#include "kwave/files.hpp"

#include "base/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <string>
#include <vector>

namespace shearwake::kwave {

namespace fs = std::filesystem;

fs::path previous_checkpoint(const fs::path& checkpoint) {
    return checkpoint.string() + ".previous";
}

fs::path usable_checkpoint(const fs::path& checkpoint, const storage::CheckpointOwner& owner) {
    std::vector<std::string> rejected;
    std::string reason;
    for (const fs::path& path : {checkpoint, previous_checkpoint(checkpoint)}) {
        if (!fs::exists(path)) continue;
        storage::CheckpointFacts facts;
        const std::string error = storage::checkpoint_error(path, owner, facts);
        if (error.empty() && !rejected.empty())
            fmt::print("note: {} {}; {} is used\n", rejected[0], reason, path.string());
        if (error.empty()) return path;
        if (rejected.empty()) reason = error;
        rejected.push_back(path.string());
    }
    if (rejected.empty()) return {};
    throw UsageError(fmt::format("{} {}; it must be an undamaged checkpoint of the same input file "
                                 "and options: remove {} to start from the beginning",
                                 rejected[0], reason, fmt::join(rejected, " and ")));
}

} // namespace shearwake::kwave
