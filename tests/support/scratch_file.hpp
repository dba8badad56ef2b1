// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <string>
#include <unistd.h>

namespace shearwake::fuzz {

/// A file with the bytes of one input, in memory if the system provides /dev/shm.
class ScratchFile {
public:
    ScratchFile(const std::uint8_t* data, std::size_t size, const std::string& extension)
        : path_(folder() / ("shearwake-fuzz-" + std::to_string(::getpid()) + extension)) {
        const int fd = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        if (fd < 0 || ::write(fd, data, size) != static_cast<ssize_t>(size)) std::abort();
        ::close(fd);
    }
    ~ScratchFile() { ::unlink(path_.c_str()); }
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;

    const std::filesystem::path& path() const { return path_; }

private:
    static std::filesystem::path folder() {
        const std::filesystem::path memory = "/dev/shm";
        return std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path();
    }
    std::filesystem::path path_;
};

} // namespace shearwake::fuzz
