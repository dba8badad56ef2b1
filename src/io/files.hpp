#pragma once

#include "base/error.hpp"

#include <array>
#include <cerrno>
#include <filesystem>
#include <string>
#include <string_view>

namespace shearwake {

/// None of these is collective; each throws UsageError with code `environment` and the system's
/// reason when the file system refuses. What is likely to pass is tried again within two seconds.

/// Values of errno after which the next attempt may go better.
inline constexpr std::array passing_errors = {
    EIO, EAGAIN, EBUSY, EINTR, ESTALE, ETIMEDOUT, EREMOTEIO, ENETDOWN, ENETUNREACH, EHOSTUNREACH};
Trouble trouble_of(int error);

std::string read_file(const std::filesystem::path& path);

/// Whole or not at all: written beside, flushed to the disk, renamed.
void write_file(const std::filesystem::path& path, std::string_view text);

/// Whether a line must be on the disk before the program goes on, or may get there in its time: it
/// outlives the program in any case, and may be lost with the machine.
enum class Flush { now, later };

/// One line at the end of a file in a single write. A last line that a kill or a full disk has cut
/// short is ended first.
void append_line(const std::filesystem::path& path, std::string_view line,
                 Flush flush = Flush::now);

void make_directory(const std::filesystem::path& path);

/// What has been written to the file so far reaches the disk.
void flush_to_disk(const std::filesystem::path& path);

/// Flushes `part` to the disk and gives it its final name.
void publish(const std::filesystem::path& part, const std::filesystem::path& path);

/// Bytes that this user may still write there.
double free_bytes(const std::filesystem::path& path);

} // namespace shearwake
