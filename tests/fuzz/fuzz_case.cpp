// What the reader of case files makes of any bytes: a summary or an Error, never anything else. On
// some bytes HDF5 itself breaks down: a copy of the process tries them out, as in the program, and
// only what it survives is read in this one, under the sanitizers.
#include "base/error.hpp"
#include "io/case_file_reader.hpp"
#include "io/guard.hpp"
#include "io/h5.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <string>
#include <unistd.h>

namespace {

/// In memory, where the system has such a place.
std::filesystem::path scratch() {
    const std::filesystem::path memory = "/dev/shm";
    const auto folder =
        std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path();
    return folder / ("shearwake-fuzz-" + std::to_string(::getpid()) + ".h5");
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const bool quiet = (shearwake::h5::never_tidy_up(), true);
    (void)quiet;
    const std::filesystem::path path = scratch();
    const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (fd < 0 || ::write(fd, data, size) != static_cast<ssize_t>(size)) std::abort();
    ::close(fd);
    try {
        shearwake::must_survive(path, [&] { shearwake::read_summary_unguarded(path); });
        (void)shearwake::read_summary_unguarded(path);
    } catch (const shearwake::Error&) {
    }
    ::unlink(path.c_str());
    return 0;
}
