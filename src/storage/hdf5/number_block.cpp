// SPDX-License-Identifier: BSD-3-Clause
#include "storage/hdf5/number_block.hpp"

#include "base/error.hpp"
#include "storage/hdf5/h5.hpp"

#include <fmt/format.h>

namespace shearwake::storage {
namespace {

constexpr std::size_t most_numbers = std::size_t{1} << 28;

/// Whether all groups on the path and the dataset exist; H5Lexists checks only one step.
bool exists(hid_t file, const std::string& path) {
    for (std::size_t slash = path.find('/', 1);; slash = path.find('/', slash + 1)) {
        if (H5Lexists(file, path.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
        if (slash == std::string::npos) return true;
    }
}

} // namespace

NumberBlock read_numbers(hid_t file, const std::string& path) {
    if (!exists(file, path)) throw UsageError(fmt::format("the dataset \"{}\" is missing", path));
    const h5::Id dataset = h5::open_dataset(file, path);
    const h5::Id type(H5Dget_type(dataset.raw()), H5Tclose, "inspect the type of " + path);
    const H5T_class_t kind = H5Tget_class(type.raw());
    if (kind != H5T_FLOAT && kind != H5T_INTEGER)
        throw UsageError(path + " does not contain numbers");
    NumberBlock block;
    std::size_t count = 1;
    for (const hsize_t extent : h5::shape(dataset)) {
        block.shape.push_back(extent);
        if (extent > 0 && count > most_numbers / extent)
            throw UsageError(fmt::format("the dataset \"{}\" contains more than {} numbers", path,
                                         most_numbers));
        count *= extent;
    }
    block.values.resize(count);
    if (count > 0)
        h5::check(H5Dread(dataset.raw(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                          block.values.data()),
                  "read " + path);
    return block;
}

} // namespace shearwake::storage
