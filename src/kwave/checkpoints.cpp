// SPDX-License-Identifier: BSD-3-Clause
#include "kwave/files.hpp"

#include "base/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>
#include <xxhash.h>

namespace shearwake::kwave {

namespace fs = std::filesystem;

namespace {

/// Removes what killed processes have left of writing this file.
void remove_parts(const fs::path& file) {
    std::error_code ignored;
    for (const std::string& name : storage::names_in(file.parent_path()))
        if (const std::string process = storage::process_in(name);
            !process.empty() && storage::has_ended(process) &&
            name == fmt::format("{}.{}.part", file.filename().string(), process))
            fs::remove(file.parent_path() / name, ignored);
}

} // namespace

fs::path previous_checkpoint(const fs::path& checkpoint) {
    return checkpoint.string() + ".previous";
}

Locks lock_files(std::initializer_list<fs::path> files) {
    Locks locks;
    for (const fs::path& file : files) {
        if (file.empty()) continue;
        locks.push_back(std::make_unique<storage::FileLock>(file.string() + ".lock"));
        if (locks.back()->is_refused())
            throw UsageError(fmt::format("another process is writing {}; wait for its end, or "
                                         "choose another file",
                                         file.string()));
        remove_parts(file);
    }
    return locks;
}

std::string identity_of(const Arguments& a, long steps) {
    std::ifstream file(a.input, std::ios::binary);
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(),
                                                                         XXH3_freeState);
    XXH3_64bits_reset(state.get());
    std::vector<char> block(1 << 20);
    while (file.read(block.data(), std::ssize(block)) || file.gcount() > 0)
        XXH3_64bits_update(state.get(), block.data(), static_cast<std::size_t>(file.gcount()));
    const std::string rest =
        fmt::format("{} {} {} {}", fmt::join(a.records, " "), a.first_step, steps, a.precision);
    XXH3_64bits_update(state.get(), rest.data(), rest.size());
    return fmt::format("{:016x}", XXH3_64bits_digest(state.get()));
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
