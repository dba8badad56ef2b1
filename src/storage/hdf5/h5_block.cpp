// SPDX-License-Identifier: BSD-3-Clause
#include "storage/hdf5/h5_block.hpp"

#include "base/error.hpp"
#include "base/units.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <hdf5_hl.h>
#include <numeric>
#include <utility>

namespace shearwake::h5 {
namespace {

/// Arguments of H5Dwrite and H5Dread in addition to the values.
struct Transfer {
    Id file, memory, properties;
};

Transfer transfer_of(const Id& dataset, const Block& block, View2<const double> values,
                     const Comm& comm) {
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
    if (comm.size() > 1)
        check(H5Pset_dxpl_mpio(t.properties.raw(), H5FD_MPIO_COLLECTIVE), "transfer collectively");
    return t;
}

} // namespace

void write_block(const Id& dataset, const Block& block, View2<const double> values,
                 const std::string& what, const Comm& comm) {
    const Transfer t = transfer_of(dataset, block, values, comm);
    const double nothing = 0.0; // HDF5 rejects the null address of an empty vector
    comm.before_collective();
    check_together(H5Dwrite(dataset.raw(), H5T_NATIVE_DOUBLE, t.memory.raw(), t.file.raw(),
                            t.properties.raw(), values.data() ? values.data() : &nothing),
                   what, comm);
}

void read_block(const Id& dataset, const Block& block, View2<double> values,
                const std::string& what, const Comm& comm) {
    const Transfer t = transfer_of(dataset, block, values, comm);
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

/// The text of an attribute of fixed or variable length; empty if it is missing or no text.
std::string text_of(hid_t object, const std::string& name) {
    if (!h5::has_attribute(object, name)) return "";
    const h5::Id attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, "open " + name);
    const h5::Id type(H5Aget_type(attribute.raw()), H5Tclose, "inspect " + name),
        space(H5Aget_space(attribute.raw()), H5Sclose, "inspect " + name);
    if (H5Tget_class(type.raw()) != H5T_STRING || H5Sget_simple_extent_npoints(space.raw()) != 1)
        return "";
    if (H5Tis_variable_str(type.raw()) <= 0) return h5::text_attribute(object, name);
    char* text = nullptr;
    h5::check(H5Aread(attribute.raw(), type.raw(), &text), "read attribute " + name);
    std::string copy = text ? text : "";
    H5free_memory(text);
    return copy;
}

/// The name of the first scale of each dimension, without its group; empty if one has none.
std::vector<std::string> scales_of(hid_t dataset, std::size_t dimensions) {
    std::vector<std::string> names;
    if (!h5::has_attribute(dataset, "DIMENSION_LIST")) return names;
    for (unsigned n = 0; n < dimensions; ++n) {
        if (H5DSget_num_scales(dataset, n) < 1) return {};
        const auto first = [](hid_t, unsigned, hid_t scale, void* out) -> herr_t {
            char name[256] = "";
            H5Iget_name(scale, name, sizeof name);
            const std::string_view path = name;
            *static_cast<std::string*>(out) = path.substr(path.find_last_of('/') + 1);
            return 1; // no further scale
        };
        names.emplace_back();
        h5::check(H5DSiterate_scales(dataset, n, nullptr, first, &names.back()), "find a scale");
    }
    return names;
}

/// The factor from the unit of a dataset, such as "mm/s", to `unit`; 1 if it states none.
double factor_of(hid_t dataset, const std::string& path, std::string_view unit) {
    const std::string attribute = text_of(dataset, "units");
    if (attribute.empty() || attribute == "1" || attribute == "none" || attribute == "SI")
        return 1.0;
    std::string text = "_" + attribute;
    for (const auto& [written, read] : {std::pair{"\u00b5", "u"},
                                        {"\u03bc", "u"},
                                        {"/", "_"},
                                        {" ", "_"},
                                        {"*", "_"},
                                        {"^", ""},
                                        {"s-1", "s"},
                                        {"m-3", "m3"},
                                        {"meters", "m"},
                                        {"metres", "m"},
                                        {"meter", "m"},
                                        {"metre", "m"},
                                        {"seconds", "s"},
                                        {"second", "s"}})
        for (std::size_t at = 0; (at = text.find(written)) != std::string::npos;)
            text.replace(at, std::strlen(written), read);
    const auto stated = unit_of("value" + text), expected = unit_of(fmt::format("value{}", unit));
    if (!expected) return 1.0;
    if (!stated || stated->suffix != text)
        throw UsageError(fmt::format("{} has the units {:.40}, which cannot be read; convert it to "
                                     "{}",
                                     path, attribute, unit.substr(1)));
    if (stated->quantity != expected->quantity)
        throw UsageError(fmt::format("{} has the units {}, but must be a {}", path, text.substr(1),
                                     expected->quantity));
    return stated->to_SI / expected->to_SI;
}

} // namespace

NumberBlock with_indices(const NumberBlock& block, const std::vector<std::size_t>& order) {
    NumberBlock turned{.values = std::vector<double>(block.values.size())};
    std::vector<std::size_t> stride(order.size()), at(order.size(), 0); // of the block's dimensions
    std::size_t step = 1;
    for (std::size_t n = order.size(); n-- > 0; step *= block.shape[order[n]])
        stride[order[n]] = step;
    for (const std::size_t axis : order)
        turned.shape.push_back(block.shape[axis]);
    for (const double value : block.values) {
        turned.values[std::inner_product(at.begin(), at.end(), stride.begin(), std::size_t{0})] =
            value;
        for (std::size_t axis = at.size(); axis-- > 0;) {
            if (++at[axis] < block.shape[axis]) break;
            at[axis] = 0;
        }
    }
    return turned;
}

NumberBlock with_reversed_indices(const NumberBlock& block) {
    std::vector<std::size_t> order(block.shape.size());
    std::iota(order.rbegin(), order.rend(), std::size_t{0});
    return with_indices(block, order);
}

NumberBlock read_numbers(hid_t file, const std::string& path, std::string_view unit) {
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
    if (const double factor = factor_of(dataset.raw(), path, unit); factor != 1.0)
        for (double& value : block.values)
            value *= factor;
    if (h5::has_attribute(dataset.raw(), "MATLAB_class")) {
        block = with_reversed_indices(block);
        block.is_of_matlab = true;
    } else
        block.scales = scales_of(dataset.raw(), block.shape.size());
    return block;
}

} // namespace shearwake::storage
