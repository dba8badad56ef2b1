// SPDX-License-Identifier: BSD-3-Clause
#include "storage/hdf5/abandoned_files.hpp"

#include "base/hash.hpp"

#include <algorithm>
#include <new>
#include <string>
#include <utility>
#include <vector>

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
