// SPDX-License-Identifier: BSD-3-Clause
#include "storage/hdf5/h5_block.hpp"

#include "base/error.hpp"

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
