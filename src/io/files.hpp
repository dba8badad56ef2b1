#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace shearwake {

/// None of these is collective; each throws UsageError with code `environment` and the system's
/// reason when the file system refuses.

std::string read_file(const std::filesystem::path& path);

/// Whole or not at all: written beside, flushed to the disk, renamed.
void write_file(const std::filesystem::path& path, std::string_view text);

/// One line at the end of a file in a single write, flushed to the disk. A last line that a kill or
/// a full disk has cut short is ended first.
void append_line(const std::filesystem::path& path, std::string_view line);

void make_directory(const std::filesystem::path& path);

/// What has been written to the file so far reaches the disk.
void flush_to_disk(const std::filesystem::path& path);

/// Flushes `part` to the disk and gives it its final name.
void publish(const std::filesystem::path& part, const std::filesystem::path& path);

/// Bytes that this user may still write there.
double free_bytes(const std::filesystem::path& path);

} // namespace shearwake
