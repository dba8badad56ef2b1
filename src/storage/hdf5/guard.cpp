// SPDX-License-Identifier: BSD-3-Clause
#include "storage/hdf5/guard.hpp"

#include "base/error.hpp"
#include "base/text.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <new>
#include <string>
#include <string_view>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace shearwake::storage {
namespace {

void limit(__rlimit_resource resource, rlim_t most) {
    struct rlimit now {};
    if (::getrlimit(resource, &now) != 0) return;
    now.rlim_cur = std::min(now.rlim_max, most);
    ::setrlimit(resource, &now);
}

bool is_trial = false;           // in a child of must_survive()
constexpr int out_of_memory = 2; // exit code of such a child

[[noreturn]] void try_out(const std::function<void()>& work, double seconds) {
    for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGINT, SIGTERM, SIGUSR1})
        std::signal(signal, SIG_DFL);
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, static_cast<rlim_t>(seconds) + 1);
    // A damaged file can also cause an infinite loop; the limit allows for busy machines.
    std::signal(SIGALRM, SIG_DFL);
    ::alarm(static_cast<unsigned>(10.0 * seconds));
    // Suppress error output of the child, which is of no use.
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    is_trial = true;
    try {
        work();
    } catch (const std::bad_alloc&) {
        ::_exit(out_of_memory);
    } catch (const std::exception& error) { // is the expected result
        const bool is_full = std::string_view(error.what()).find(": memory allocation failed") !=
                             std::string_view::npos; // words of HDF5
        ::_exit(is_full ? out_of_memory : 0);
    }
    ::_exit(0);
}

/// Throws UsageError if the file system stores less than a hundredth of a file above 64 MB.
void refuse_holes(const std::filesystem::path& path, double size_B) {
    const int file = size_B > 64e6 ? ::open(path.c_str(), O_RDONLY | O_CLOEXEC) : -1;
    if (file < 0) return; // HDF5 reports why it cannot open it
    double stored_B = 0.0;
    off_t start = 0;
    for (off_t end = 0; start >= 0 && 100.0 * stored_B < size_B;) {
        start = ::lseek(file, end, SEEK_DATA); // -1: nothing but a hole is left
        if (start >= 0) end = ::lseek(file, start, SEEK_HOLE);
        stored_B += start >= 0 ? static_cast<double>(end - start) : 0.0;
    }
    const bool is_sparse = start < 0 && errno == ENXIO; // not a file system without SEEK_DATA
    ::close(file);
    if (is_sparse)
        throw UsageError(fmt::format("it is a sparse file: it has {:.0f} MB but stores {:.3g} kB",
                                     size_B / 1e6, stored_B / 1e3));
}

/// The status of a child that runs `work`; 0 if none can be created. `seconds`: limit of its CPU
/// time.
int trial_status(const std::function<void()>& work, double seconds) {
    // Buffered output would otherwise be written by both processes.
    std::fflush(nullptr);
    const pid_t child = ::fork();
    if (child < 0) return 0;
    if (child == 0) try_out(work, seconds);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0)
        if (errno != EINTR) return 0;
    return status;
}

} // namespace

void limit_trial_memory(double more_B) {
    if (!is_trial || !(more_B < 1e15)) return; // the readers reject larger claims
    std::ifstream sizes("/proc/self/statm");
    double pages = 0.0;
    if (sizes >> pages)
        limit(RLIMIT_AS,
              static_cast<rlim_t>(pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) + more_B));
}

void must_survive(const std::filesystem::path& file, const std::function<void()>& read) {
    // A library that needs longer is caught in a loop.
    constexpr double slowest_B_s = 20e6;
    std::error_code unknown;
    const auto size_B = static_cast<double>(std::filesystem::file_size(file, unknown));
    refuse_holes(file, unknown ? 0.0 : size_B);
    const double seconds = 5.0 + (unknown ? 0.0 : size_B / slowest_B_s);
    const int status = trial_status(read, seconds);
    if (WIFEXITED(status) && WEXITSTATUS(status) == out_of_memory)
        throw Error("it needs more memory than its datasets explain; it is damaged, or a chunk "
                    "decompresses to more than it states");
    if (status != 0)
        throw Error(fmt::format("{} is damaged in a way that crashes the HDF5 library or keeps it "
                                "busy for more than {:.0f} s",
                                file.string(), seconds));
}

} // namespace shearwake::storage

namespace shearwake::h5 {
namespace {

/// HDF5 has one list of open files per program, too.
std::vector<hid_t>& abandoned_files() {
    static std::vector<hid_t> files;
    return files;
}

/// A number that is equal on ranks that have abandoned the same files, with probability 1 - 2^-31;
/// -1 if memory is lacking. Sorts the files in the order in which they were opened.
int digest_of(std::vector<hid_t>& files) noexcept {
    try {
        std::sort(files.begin(), files.end());
        std::uint64_t hash = stable_hash("");
        for (const hid_t file : files) {
            const ssize_t length = H5Fget_name(file, nullptr, 0);
            std::string name(static_cast<std::size_t>(std::max<ssize_t>(length, 0)) + 1, '\0');
            H5Fget_name(file, name.data(), name.size());
            hash = stable_hash(name, hash);
        }
        return static_cast<int>(hash >> 33);
    } catch (const std::bad_alloc&) {
        return -1;
    }
}

} // namespace

void abandon_file(hid_t file) noexcept {
    try {
        abandoned_files().push_back(file);
    } catch (const std::bad_alloc&) { // it remains open until the program ends
    }
}

void close_abandoned(const Comm& comm) {
    std::vector<hid_t> files = std::exchange(abandoned_files(), {});
    const int digest = digest_of(files);
    if (const int lowest = comm.min(digest); lowest < 0 || lowest != comm.max(digest)) return;
    comm.before_collective();
    for (const hid_t file : files)
        H5Fclose(file);
}

} // namespace shearwake::h5
