// SPDX-License-Identifier: BSD-3-Clause
// For arbitrary bytes, the reader of material maps must return a map or throw Error.
#include "base/error.hpp"
#include "storage/hdf5/h5.hpp"
#include "storage/input/input_files.hpp"
#include "support/scratch_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const bool quiet = (shearwake::h5::never_tidy_up(), true);
    (void)quiet;
    const shearwake::fuzz::ScratchFile file(data, size, ".h5");
    try {
        (void)shearwake::storage::read_map_file(file.path());
    } catch (const shearwake::Error&) {
    }
    return 0;
}
