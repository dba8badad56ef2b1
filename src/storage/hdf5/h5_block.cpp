// SPDX-License-Identifier: BSD-3-Clause
#include "storage/hdf5/h5_block.hpp"

#include "base/error.hpp"
#include "storage/hdf5/h5.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::h5 {
namespace {

/// Arguments of H5Dwrite and H5Dread in addition to the values.
struct Transfer {
    Id file, memory, properties;
};

Transfer transfer_of(const Id& dataset, const Block& block, View2<const double> values) {
    const bool empty = values.rows() == 0 || values.columns() == 0;
    const hsize_t in_memory[2] = {std::max<hsize_t>(static_cast<hsize_t>(values.rows()), 1),
                                  std::max<hsize_t>(static_cast<hsize_t>(values.stride()), 1)};
    const hsize_t origin[2] = {0, 0};
    const hsize_t taken[2] = {static_cast<hsize_t>(values.rows()),
                              static_cast<hsize_t>(values.columns())};
    Transfer t{Id(H5Dget_space(dataset.raw()), H5Sclose, "find a dataspace"),
               Id(H5Screate_simple(2, in_memory, nullptr), H5Sclose, "create a dataspace"),
               Id(H5Pcreate(H5P_DATASET_XFER), H5Pclose, "create a property list")};
    if (empty) {
        check(H5Sselect_none(t.file.raw()), "select nothing");
        check(H5Sselect_none(t.memory.raw()), "select nothing");
    } else {
        check(H5Sselect_hyperslab(t.file.raw(), H5S_SELECT_SET, block.start.data(), nullptr,
                                  block.count.data(), nullptr),
              "select a block");
        check(H5Sselect_hyperslab(t.memory.raw(), H5S_SELECT_SET, origin, nullptr, taken, nullptr),
              "select a block");
    }
    check(H5Pset_dxpl_mpio(t.properties.raw(), H5FD_MPIO_COLLECTIVE), "transfer collectively");
    return t;
}

} // namespace

void write_block(const Id& dataset, const Block& block, View2<const double> values,
                 const std::string& what, const Comm& comm) {
    const Transfer t = transfer_of(dataset, block, values);
    const double nothing = 0.0; // HDF5 rejects the null address of an empty vector
    comm.before_collective();
    check_together(H5Dwrite(dataset.raw(), H5T_NATIVE_DOUBLE, t.memory.raw(), t.file.raw(),
                            t.properties.raw(), values.data() ? values.data() : &nothing),
                   what, comm);
}

void read_block(const Id& dataset, const Block& block, View2<double> values,
                const std::string& what, const Comm& comm) {
    const Transfer t = transfer_of(dataset, block, values);
    double nothing = 0.0;
    comm.before_collective();
    check_together(H5Dread(dataset.raw(), H5T_NATIVE_DOUBLE, t.memory.raw(), t.file.raw(),
                           t.properties.raw(), values.data() ? values.data() : &nothing),
                   what, comm);
}

} // namespace shearwake::h5

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
