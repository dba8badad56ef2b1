// SPDX-License-Identifier: BSD-3-Clause
// For arbitrary bytes, as CSV and as HDF5, the readers of motions and stresses must return a result
// or throw Error.
#include "base/error.hpp"
#include "storage/hdf5/h5.hpp"
#include "storage/input/input_files.hpp"
#include "support/scratch_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const bool quiet = (shearwake::h5::never_tidy_up(), true);
    (void)quiet;
    constexpr std::string_view hdf5 = "\x89HDF";
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    const shearwake::fuzz::ScratchFile file(data, size, bytes.starts_with(hdf5) ? ".h5" : ".csv");
    try {
        (void)shearwake::storage::read_motion(file.path(), "");
    } catch (const shearwake::Error&) {
    }
    try {
        (void)shearwake::storage::read_stress(file.path(), "");
    } catch (const shearwake::Error&) {
    }
    return 0;
}
