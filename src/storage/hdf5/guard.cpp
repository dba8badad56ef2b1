// SPDX-License-Identifier: BSD-3-Clause
#include "storage/hdf5/guard.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "storage/hdf5/h5.hpp"

#include <algorithm>
#include <array>
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

bool is_trial = false;           // in a child of try_in_child()
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
        // Words of HDF5 up to 1.12, and of 1.14, which does not distinguish damaged chunks.
        const std::string_view text = error.what();
        const bool is_full = text.find(": memory allocation failed") != text.npos ||
                             text.find(": filter returned failure") != text.npos;
        ::_exit(is_full ? out_of_memory : 0);
    }
    ::_exit(0);
}

/// Throws UsageError if the file system stores less than a hundredth of a file above 64 MB.
void refuse_holes(const std::filesystem::path& path, double size_B) {
    const int file = size_B > always_allowed_B ? ::open(path.c_str(), O_RDONLY | O_CLOEXEC) : -1;
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

void try_in_child(const std::filesystem::path& file, const std::function<void()>& read) {
    // A library that needs longer is caught in a loop.
    constexpr double slowest_B_s = 20e6;
    std::error_code unknown;
    if (!std::filesystem::is_regular_file(file, unknown))
        throw UsageError(file.string() + " is not a regular file");
    const auto size_B = static_cast<double>(std::filesystem::file_size(file, unknown));
    refuse_holes(file, unknown ? 0.0 : size_B);
    const double seconds = 5.0 + (unknown ? 0.0 : size_B / slowest_B_s);
    const int status = trial_status(read, seconds);
    if (WIFEXITED(status) && WEXITSTATUS(status) == out_of_memory)
        throw Error("a chunk cannot be decompressed, or only with more memory than its datasets "
                    "explain; it is damaged, or decompresses to more than it states");
    if (status != 0)
        throw Error(fmt::format("{} is damaged in a way that crashes the HDF5 library or keeps it "
                                "busy for more than {:.0f} s",
                                file.string(), seconds));
}

namespace {

/// The number of bytes of the values of a dataset, in floating point, where claims do not overflow.
double claimed_B(hid_t dataset) {
    const h5::Id space(H5Dget_space(dataset), H5Sclose, "inspect a dataset"),
        type(H5Dget_type(dataset), H5Tclose, "inspect a dataset");
    return static_cast<double>(std::max<hssize_t>(H5Sget_simple_extent_npoints(space.raw()), 0)) *
           static_cast<double>(std::max(H5Tget_size(type.raw()), sizeof(double)));
}

/// Rejects values in other files (external storage and virtual datasets), and chunks that are
/// larger than the dataset, since HDF5 allocates complete chunks.
void require_own_values(hid_t dataset, const std::string& name) {
    const h5::Id creation(H5Dget_create_plist(dataset), H5Pclose, "inspect dataset " + name);
    if (H5Pget_external_count(creation.raw()) > 0 || H5Pget_layout(creation.raw()) == H5D_VIRTUAL)
        throw Error(fmt::format(
            "dataset \"{:.200}\" stores its values in another file, which is not read", name));
    if (H5Pget_layout(creation.raw()) != H5D_CHUNKED) return;
    std::array<hsize_t, H5S_MAX_RANK> extents{};
    const int rank = H5Pget_chunk(creation.raw(), H5S_MAX_RANK, extents.data());
    double chunk_B = sizeof(double);
    for (int n = 0; n < rank; ++n)
        chunk_B *= static_cast<double>(extents[static_cast<std::size_t>(n)]);
    if (chunk_B > std::max(always_allowed_B, claimed_B(dataset)))
        throw Error(
            fmt::format("dataset \"{:.200}\" has chunks of {:.0f} MB, more than the dataset", name,
                        chunk_B / 1e6));
}

struct Contents {
    std::string error;
    double claimed_B = 0.0; // of all datasets
};

} // namespace

double require_self_contained(hid_t file) {
    Contents contents;
    const auto visit = [](hid_t root, const char* name, const H5L_info_t* link,
                          void* out) -> herr_t {
        auto& found = *static_cast<Contents*>(out);
        try {
            if (link->type > H5L_TYPE_SOFT)
                throw Error(fmt::format(
                    "the link \"{:.200}\" leads to another file, which is not read", name));
            if (link->type != H5L_TYPE_HARD) return 0;
            const h5::Id object(H5Oopen(root, name, H5P_DEFAULT), H5Oclose, "open an object");
            if (H5Iget_type(object.raw()) != H5I_DATASET) return 0;
            require_own_values(object.raw(), name);
            found.claimed_B += claimed_B(object.raw());
        } catch (const std::exception& error) { // no exception may pass through the C library
            found.error = error.what();
            return 1;
        }
        return 0;
    };
    h5::check(H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, visit, &contents), "list the links");
    if (!contents.error.empty()) throw Error(contents.error);
    return contents.claimed_B;
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
