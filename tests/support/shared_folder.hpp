// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/agree.hpp"

#include <filesystem>
#include <string>
#include <unistd.h>

namespace shearwake::test {

/// A folder whose path all ranks have and which is deleted at the end of the test. Collective.
class SharedFolder {
public:
    explicit SharedFolder(const Comm& world) : world_(world) {
        path_ = world.broadcast(
            (std::filesystem::temp_directory_path() / ("shearwake-" + std::to_string(::getpid())))
                .string());
        on_root(world_, [&] { std::filesystem::create_directories(path_); });
    }
    ~SharedFolder() {
        world_.barrier();
        if (world_.is_root()) std::filesystem::remove_all(path_);
    }
    std::filesystem::path file(const std::string& name) const { return path_ / name; }

private:
    Comm world_;
    std::filesystem::path path_;
};

} // namespace shearwake::test
