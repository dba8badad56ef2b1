// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/provenance.hpp"

#include "fft/line_transform.hpp"
#include "git_id.hpp"
#include "parallel/session.hpp"
#include "simd/instruction_set.hpp"
#include "storage/hdf5/h5.hpp"
#include "storage/journal/journal.hpp"

#include <fmt/format.h>

namespace shearwake::pipeline {
namespace {

std::string compiler() {
#ifdef __clang__
    return fmt::format("clang++ {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
    return fmt::format("g++ {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

/// The instruction sets that this program and processor support, such as "baseline, avx2, avx512".
std::string available_kernels() {
    using simd::InstructionSet;
    std::string names;
    for (const auto set : {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512})
        if (set <= simd::best_instruction_set())
            names += fmt::format("{}{}", names.empty() ? "" : ", ", simd::name_of(set));
    return names;
}

} // namespace

std::string program_version() {
    return SHEARWAKE_VERSION;
}

std::string program_git_id() {
    return SHEARWAKE_GIT_ID;
}

std::vector<Attribute> program_attributes() {
    return {{"program", "shearwake " + program_version()},
            {"git_id", program_git_id()},
            {"compiler", compiler()},
            {"build_type", std::string(SHEARWAKE_BUILD_TYPE)},
            {"kernels", std::string(simd::name_of(simd::instruction_set()))},
            {"mpi_version", mpi_version()},
            {"fftw_version", fft::fftw_library_version()},
            {"hdf5_version", h5::library_version()},
            {"host", storage::host_name()}};
}

std::string version_text() {
    return fmt::format("shearwake {}\ngit       {}\ncompiler  {}, {}\nkernels   {} of {} "
                       "(SHEARWAKE_SIMD selects others)\nMPI       {}\nFFTW      {}\n"
                       "HDF5      {}\nGPU       {}",
                       SHEARWAKE_VERSION, SHEARWAKE_GIT_ID, compiler(), SHEARWAKE_BUILD_TYPE,
                       simd::name_of(simd::instruction_set()), available_kernels(), mpi_version(),
                       fft::fftw_library_version(), h5::library_version(), SHEARWAKE_GPU_TEXT);
}

} // namespace shearwake::pipeline
