// SPDX-License-Identifier: BSD-3-Clause
#include "storage/hdf5/guard.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "storage/hdf5/h5.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <new>
#include <string>
#include <utility>
#include <vector>

namespace shearwake::storage {
namespace {

/// Rejects external storage and virtual datasets.
void require_own_values(hid_t dataset, const std::string& name) {
    const h5::Id creation(H5Dget_create_plist(dataset), H5Pclose, "inspect dataset " + name);
    if (H5Pget_external_count(creation.raw()) > 0 || H5Pget_layout(creation.raw()) == H5D_VIRTUAL)
        throw Error(fmt::format(
            "dataset \"{:.200}\" stores its values in another file, which is not read", name));
}

} // namespace

void require_self_contained(hid_t file) {
    std::string problem;
    const auto visit = [](hid_t root, const char* name, const H5L_info_t* link,
                          void* out) -> herr_t {
        try {
            if (link->type > H5L_TYPE_SOFT)
                throw Error(fmt::format(
                    "the link \"{:.200}\" leads to another file, which is not read", name));
            if (link->type != H5L_TYPE_HARD) return 0;
            const h5::Id object(H5Oopen(root, name, H5P_DEFAULT), H5Oclose, "open an object");
            if (H5Iget_type(object.raw()) == H5I_DATASET) require_own_values(object.raw(), name);
        } catch (const std::exception& error) { // no exception may pass through the C library
            *static_cast<std::string*>(out) = error.what();
            return 1;
        }
        return 0;
    };
    h5::check(H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, visit, &problem), "list the links");
    if (!problem.empty()) throw Error(problem);
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
