// SPDX-License-Identifier: BSD-3-Clause
#include "storage/files.hpp"

#include "base/csv.hpp"
#include "base/python_module.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <memory>
#include <fstream>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <utility>

namespace shearwake::storage {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(std::string_view what, const fs::path& path, int error) {
    throw UsageError(fmt::format("{} {}: {}", what, path.string(), std::strerror(error)),
                     ExitCode::environment, persistence_of(error));
}

/// An open file descriptor.
class Descriptor {
public:
    Descriptor(const fs::path& path, int flags)
        : fd_(::open(path.c_str(), flags, 0666)), path_(path) {
        if (fd_ < 0) refuse("cannot open", path, errno);
    }
    ~Descriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;

    void write(std::string_view text) const {
        while (!text.empty()) {
            const ssize_t written = ::write(fd_, text.data(), text.size());
            if (written < 0 && errno == EINTR) continue;
            if (written < 0) refuse("cannot write", path_, errno);
            text.remove_prefix(static_cast<std::size_t>(written));
        }
    }
    bool ends_within_a_line() const {
        const off_t end = ::lseek(fd_, 0, SEEK_END);
        char last = '\n';
        return end > 0 && ::pread(fd_, &last, 1, end - 1) == 1 && last != '\n';
    }
    void flush() const {
        if (::fsync(fd_) != 0) refuse("cannot flush", path_, errno);
    }
    /// CIFS, sshfs and others do not have this operation for folders.
    void flush_folder() const {
        if (::fsync(fd_) != 0 && errno != EINVAL && errno != ENOTSUP)
            refuse("cannot flush", path_, errno);
    }
    void commit() {
        const int fd = std::exchange(fd_, -1);
        if (::close(fd) != 0) refuse("cannot close", path_, errno);
    }

private:
    int fd_;
    fs::path path_;
};

void flush_directory(const fs::path& path) {
    const fs::path parent = path.parent_path();
    Descriptor(parent.empty() ? fs::path(".") : parent, O_RDONLY | O_DIRECTORY).flush_folder();
}

/// Gives a flushed file its final name.
void give_name(const fs::path& part, const fs::path& path) {
    std::error_code error;
    if (fs::exists(path, error) && !fs::is_regular_file(path, error))
        refuse("cannot replace, because it is not a regular file,", path, EINVAL);
    fs::rename(part, path, error);
    if (error) refuse("cannot rename to", path, error.value());
    flush_directory(path);
}

} // namespace

Persistence persistence_of(int error) {
    const bool passing = std::ranges::find(passing_errors, error) != passing_errors.end();
    return passing ? Persistence::passing : Persistence::lasting;
}

bool is_csv(const std::filesystem::path& path) {
    return path.extension() == ".csv" || path.extension() == ".CSV";
}

std::uintmax_t regular_size_B(const fs::path& path) {
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0) refuse("cannot read", path, errno);
    if (S_ISDIR(info.st_mode)) refuse("cannot read", path, EISDIR);
    if (!S_ISREG(info.st_mode))
        throw UsageError(fmt::format("cannot read {}: it is a device or a pipe, not a regular file",
                                     path.string()),
                         ExitCode::environment);
    return static_cast<std::uintmax_t>(info.st_size);
}

std::string read_file(const fs::path& path, std::uintmax_t most_B) {
    const std::uintmax_t size_B = regular_size_B(path);
    if (size_B > most_B)
        throw UsageError(
            fmt::format("cannot read {}: it has {:.0f} MB, but at most {:.0f} MB are read",
                        path.string(), static_cast<double>(size_B) / 1e6,
                        static_cast<double>(most_B) / 1e6),
            ExitCode::environment);
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file) refuse("cannot read", path, errno ? errno : EIO);
    std::string text(size_B, '\0');
    file.read(text.data(), static_cast<std::streamsize>(size_B));
    if (file.bad()) refuse("cannot read", path, errno ? errno : EIO);
    text.resize(static_cast<std::size_t>(file.gcount())); // truncated in the meantime
    return text;
}

std::string read_user_text(const fs::path& folder, const std::string& file) {
    if (!file.starts_with(played_file)) return read_file(folder / file, largest_user_text_B);
    std::string text; // the standard error, which is also that of messages
    if (run_python_module("shearwake.device.read", {folder / file.substr(played_file.size())},
                          device_packages, &text) == 0)
        return text;
    throw UsageError(std::string(trimmed(text)), ExitCode::bad_job);
}

namespace {

std::string short_host_name() {
    char name[256] = {};
    if (::gethostname(name, sizeof name - 1) != 0) return "unknown";
    const std::string_view host(name);
    return std::string(host.substr(0, host.find('.')));
}

} // namespace

std::string process_name() {
    return fmt::format("{}-{}", short_host_name(), ::getpid());
}

bool has_ended(const std::string& process) {
    const auto dash = process.find_last_of('-');
    if (dash == std::string::npos || process.substr(0, dash) != short_host_name()) return false;
    const int pid = std::atoi(process.c_str() + dash + 1);
    if (pid <= 0) return false;
    if (::kill(pid, 0) != 0 && errno == ESRCH) return true;
    // It may have ended without having been waited for, and then has no program.
    std::error_code error, none;
    return fs::read_symlink(fmt::format("/proc/{}/exe", pid), error).empty() &&
           error == std::errc::no_such_file_or_directory && fs::exists("/proc/self/exe", none);
}

fs::path part_path(const fs::path& path) {
    return fmt::format("{}.{}.part", path.string(), process_name());
}

std::string process_in(const fs::path& part) {
    const std::string process = part.stem().extension().string();
    return part.extension() != ".part" || process.empty() ? "" : process.substr(1);
}

bool is_stray(const fs::path& file) {
    const std::string name = file.filename().string();
    return name.starts_with('.') || name.ends_with('~') || name.find(' ') != std::string::npos;
}

void write_file(const fs::path& path, std::string_view text) {
    const fs::path part = part_path(path);
    try {
        with_patience([&] {
            Descriptor file(part, O_WRONLY | O_CREAT | O_TRUNC);
            file.write(text);
            file.flush();
            file.commit();
            give_name(part, path);
        });
    } catch (...) {
        std::error_code ignored;
        fs::remove(part, ignored);
        throw;
    }
}

void append_line(const fs::path& path, std::string_view line, Flush flush) {
    with_patience([&] {
        Descriptor file(path, O_RDWR | O_CREAT | O_APPEND);
        file.write((file.ends_within_a_line() ? "\n" : "") + std::string(line) + "\n");
        if (flush == Flush::now) file.flush();
        file.commit();
    });
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    const std::unique_ptr<DIR, int (*)(DIR*)> stream(::opendir(folder.c_str()), &::closedir);
    while (const dirent* entry = stream ? ::readdir(stream.get()) : nullptr)
        if (const std::string name = entry->d_name; name != "." && name != "..")
            names.push_back(name);
    return names;
}

void make_directory(const fs::path& path) {
    std::error_code error;
    fs::create_directories(path, error);
    if (error) refuse("cannot create the folder", path, error.value());
}

void flush_to_disk(const fs::path& path) {
    Descriptor(path, O_RDONLY).flush();
}

void publish(const fs::path& part, const fs::path& path) {
    flush_to_disk(part);
    give_name(part, path);
}

double free_bytes(const fs::path& path) {
    struct statvfs info {};
    if (::statvfs(path.c_str(), &info) != 0) refuse("cannot query", path, errno);
    return static_cast<double>(info.f_bavail) * static_cast<double>(info.f_frsize);
}

FileLock::FileLock(fs::path file, std::chrono::milliseconds patience) : path_(std::move(file)) {
    const auto end = std::chrono::steady_clock::now() + patience;
    struct stat held {
    }, named{};
    do { // again if the process that held it has just removed it
        if (fd_ >= 0) ::close(fd_);
        fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (fd_ < 0) refuse("cannot open", path_, errno);
        while (::flock(fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            if (std::chrono::steady_clock::now() >= end) {
                ::close(fd_);
                fd_ = -1;
                return;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
    } while (::fstat(fd_, &held) != 0 || ::stat(path_.c_str(), &named) != 0 ||
             held.st_ino != named.st_ino);
}

FileLock::~FileLock() {
    if (is_refused()) return;
    ::unlink(path_.c_str());
    ::close(fd_);
}

} // namespace shearwake::storage
