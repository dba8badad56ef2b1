// SPDX-License-Identifier: BSD-3-Clause
#include "storage/case_file/surface_reader.hpp"

#include "base/error.hpp"

#include <array>

namespace shearwake::storage {

SurfaceReader::SurfaceReader(const std::filesystem::path& path)
    : file_(h5::open_file(path, h5::Access::read)),
      field_(h5::open_dataset(file_.raw(), "surface/u_z")), shape_(h5::shape(field_)) {
    if (shape_.size() != 4) throw Error(path.string() + " has no surfaces of u_z");
}

void SurfaceReader::read(std::size_t time, std::size_t depth, std::span<double> u_z_m) const {
    const std::array<hsize_t, 4> start = {time, depth, 0, 0}, count = {1, 1, shape_[2], shape_[3]};
    const hsize_t values = u_z_m.size();
    if (values != count[2] * count[3]) throw Error("a stored surface has another size");
    const h5::Id space(H5Dget_space(field_.raw()), H5Sclose, "find a dataspace");
    h5::check(H5Sselect_hyperslab(space.raw(), H5S_SELECT_SET, start.data(), nullptr, count.data(),
                                  nullptr),
              "select a surface");
    const h5::Id memory(H5Screate_simple(1, &values, nullptr), H5Sclose, "create a dataspace");
    h5::check(H5Dread(field_.raw(), H5T_NATIVE_DOUBLE, memory.raw(), space.raw(), H5P_DEFAULT,
                      u_z_m.data()),
              "read a surface");
}

std::vector<double> read_first_trace(const std::filesystem::path& path) {
    const h5::Id file = h5::open_file(path, h5::Access::read);
    const h5::Id traces = h5::open_dataset(file.raw(), "traces/u_z");
    std::vector<double> values = h5::read_all(traces);
    values.resize(h5::shape(traces).at(1)); // trace, time
    return values;
}

} // namespace shearwake::storage
