#include "sweep/provenance.hpp"

#include "fft/line_transform.hpp"
#include "git_id.hpp"
#include "io/h5.hpp"
#include "io/journal.hpp"
#include "parallel/session.hpp"

#include <fmt/format.h>

namespace shearwake {
namespace {

std::string compiler() {
    return fmt::format("g++ {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
}

} // namespace

std::string program_git_id() {
    return SHEARWAKE_GIT_ID;
}

std::vector<Attribute> program_attributes() {
    return {{"program", std::string("shearwake ") + SHEARWAKE_VERSION},
            {"git_id", program_git_id()},
            {"compiler", compiler()},
            {"build_type", std::string(SHEARWAKE_BUILD_TYPE)},
            {"mpi_version", mpi_version()},
            {"fftw_version", fftw_library_version()},
            {"hdf5_version", h5::library_version()},
            {"host", host_name()}};
}

std::string version_text() {
    return fmt::format("shearwake {}\ngit       {}\ncompiler  {}, {}\nMPI       {}\nFFTW      {}\n"
                       "HDF5      {}",
                       SHEARWAKE_VERSION, SHEARWAKE_GIT_ID, compiler(), SHEARWAKE_BUILD_TYPE,
                       mpi_version(), fftw_library_version(), h5::library_version());
}

} // namespace shearwake
