// SPDX-License-Identifier: BSD-3-Clause
// For arbitrary bytes, the reader of case files must return a summary or throw Error. HDF5 itself
// crashes on some inputs: a forked child reads them first, and this process reads only inputs on
// which the child does not crash, with the sanitizers.
#include "base/error.hpp"
#include "storage/case_file/case_file_reader.hpp"
#include "storage/checksum/checksum.hpp"
#include "storage/hdf5/guard.hpp"
#include "storage/hdf5/h5.hpp"
#include "support/scratch_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const bool quiet = (shearwake::h5::never_tidy_up(), true);
    (void)quiet;
    const shearwake::fuzz::ScratchFile file(data, size, ".h5");
    const auto read = [&] { (void)shearwake::storage::read_unverified_summary(file.path()); };
    try {
        shearwake::storage::try_in_child(file.path(), read);
        read();
        (void)shearwake::storage::check_integrity(file.path());
    } catch (const shearwake::Error&) {
    }
    return 0;
}
