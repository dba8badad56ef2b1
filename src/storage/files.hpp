// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>
#include <thread>

namespace shearwake::storage {

/// None of these functions is collective. After an error of the file system, each throws UsageError
/// with code `environment` and the reason of the operating system. Temporary errors are retried for
/// up to two seconds.

/// Values of errno after which a retry may succeed.
inline constexpr std::array passing_errors = {
    EIO, EAGAIN, EBUSY, EINTR, ESTALE, ETIMEDOUT, EREMOTEIO, ENETDOWN, ENETUNREACH, EHOSTUNREACH};
Persistence persistence_of(int error);

/// Journals of large sweeps have some megabytes.
inline constexpr std::uintmax_t largest_text_B = std::uintmax_t{1} << 30;
/// User files: jobs, points of paths, motions. Two copies and their numbers fit into 300 MB.
inline constexpr std::uintmax_t largest_user_text_B = std::uintmax_t{1} << 26;

/// Reads a regular file; devices and pipes may be endless or block. Throws UsageError (environment)
/// for another kind of file, or a longer one.
std::string read_file(const std::filesystem::path& path, std::uintmax_t most_B = largest_text_B);

/// The text of a file to which a job refers. After the prefix `played_file`, the module
/// shearwake.device.read checks and converts what a device plays.
std::string read_user_text(const std::filesystem::path& folder, const std::string& file);

/// Whether the name of a file ends with .csv or .CSV. Not collective.
bool is_csv(const std::filesystem::path& path);

/// The size of a regular file; throws UsageError (environment) for another kind of file.
std::uintmax_t regular_size_B(const std::filesystem::path& path);

/// "<host>-<process>", with the host up to its first dot. It names the files of a process, since
/// other processes write to the same folder at the same time.
std::string process_name();

/// Whether the process of that name was one of this host and has ended.
bool has_ended(const std::string& process);

/// The temporary name of a file while this process writes it: `<path>.<host>-<process>.part`.
std::filesystem::path part_path(const std::filesystem::path& path);

/// The process in a name of part_path(); empty for other names.
std::string process_in(const std::filesystem::path& part);

/// Whether another program has given a file in an output folder its name: `._<name>` and .DS_Store
/// of macOS, `<name>~` of editors, and copies such as `<name> (1)` and `<name> (conflicted copy)`
/// of browsers and cloud storage. Names of our files contain no blank and begin with no dot.
bool is_stray(const std::filesystem::path& file);

/// Writes a file atomically: under a temporary name, flushed to the disk, then renamed.
void write_file(const std::filesystem::path& path, std::string_view text);

/// Whether a line must be flushed to the disk before the program continues. Otherwise it survives a
/// crash of the program, but may be lost in a crash of the machine.
enum class Flush { now, later };

/// Appends one line to a file in a single write. An incomplete last line, left by a kill or a full
/// disk, is ended first.
void append_line(const std::filesystem::path& path, std::string_view line,
                 Flush flush = Flush::now);

/// The names in a folder, in any order; none if it cannot be read. Throws std::bad_alloc, where the
/// iterator of the standard library ends the program.
std::vector<std::string> names_in(const std::filesystem::path& folder);

void make_directory(const std::filesystem::path& path);

/// Flushes the file to the disk.
void flush_to_disk(const std::filesystem::path& path);

/// Does `work`, and repeats all of it after temporary errors, since network file systems fail
/// occasionally and recover. Data that a failed fsync has lost are not written by the next one.
template <class Work>
void with_patience(const Work& work) {
    for (const int pause_ms : {20, 200, 1000}) {
        try {
            return work();
        } catch (const UsageError& error) {
            if (error.persistence() == Persistence::lasting) throw;
            std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
        }
    }
    work();
}

/// Flushes `part` to the disk and gives it its final name.
void publish(const std::filesystem::path& part, const std::filesystem::path& path);

/// Free space for this user in bytes.
double free_bytes(const std::filesystem::path& path);

/// Excludes other processes by a lock of a file, which is removed at the end. File systems without
/// locks exclude none.
class FileLock {
public:
    /// Waits at most for the time `patience`. Throws UsageError (environment) if the file cannot be
    /// created.
    explicit FileLock(std::filesystem::path file, std::chrono::milliseconds patience = {});
    ~FileLock();
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

    /// Whether another process still holds it.
    bool is_refused() const { return fd_ < 0; }

private:
    std::filesystem::path path_;
    int fd_ = -1;
};

} // namespace shearwake::storage
