#pragma once

#include "parallel/agree.hpp"

#include <filesystem>
#include <string>
#include <unistd.h>

namespace shearwake::test {

/// A folder that all ranks know and that goes with the test.
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
