// SPDX-License-Identifier: BSD-3-Clause
#include "storage/case_file/case_file_reader.hpp"

#include "base/error.hpp"
#include "storage/checksum/checksum.hpp"
#include "storage/hdf5/h5.hpp"

#include <array>
#include <hdf5.h>

namespace shearwake::storage {

namespace {

void read_attributes(hid_t file, CaseSummary& summary) {
    const auto visit = [](hid_t object, const char* name, const H5A_info_t*, void* out) -> herr_t {
        auto& into = *static_cast<CaseSummary*>(out);
        try {
            const h5::Id attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, "open attribute");
            const h5::Id type(H5Aget_type(attribute.raw()), H5Tclose, "look at attribute");
            if (H5Tget_class(type.raw()) == H5T_STRING)
                into.texts[name] = h5::text_attribute(object, name);
            else
                into.numbers[name] = h5::number_attribute(object, name);
        } catch (const std::exception&) {
            return -1; // no exception may pass through the C library
        }
        return 0;
    };
    h5::check(H5Aiterate2(file, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, visit, &summary),
              "read the attributes");
}

} // namespace

CaseSummary read_case_summary(const std::filesystem::path& path) {
    const IntegrityCheck check = check_integrity(path);
    if (!check.damage.empty()) throw Error("it is damaged: " + check.damage);
    // A file that matches its checksum contains nothing that HDF5 does not expect.
    return read_unverified_summary(path);
}

CaseSummary read_unverified_summary(const std::filesystem::path& path) {
    const h5::Id file = h5::open_file(path, h5::Access::read);
    CaseSummary summary;
    read_attributes(file.raw(), summary);
    for (const char* needed : {"status", "case_id", "title"})
        if (!summary.texts.contains(needed))
            throw Error(path.string() + " is not a shearwake case file (attribute " + needed +
                        " is missing)");
    for (const std::string& name : h5::dataset_names(file.raw())) {
        const h5::Id dataset = h5::open_dataset(file.raw(), name);
        Variable variable{.name = name};
        if (h5::has_attribute(dataset.raw(), "units"))
            variable.units = h5::text_attribute(dataset.raw(), "units");
        if (h5::has_attribute(dataset.raw(), "long_name"))
            variable.long_name = h5::text_attribute(dataset.raw(), "long_name");
        if (h5::has_attribute(dataset.raw(), "note"))
            variable.note = h5::text_attribute(dataset.raw(), "note");
        const auto shape = h5::shape(dataset);
        if (shape.empty()) {
            variable.values = h5::read_all(dataset);
            summary.scalars.push_back(std::move(variable));
        } else {
            for (const hsize_t extent : shape)
                variable.dimensions.push_back(std::to_string(extent));
            summary.shapes.push_back(std::move(variable));
        }
    }
    return summary;
}

bool is_complete(const std::filesystem::path& path, const std::string& id) {
    if (!std::filesystem::exists(path)) return false;
    try {
        if (!check_integrity(path).damage.empty()) return false;
        const h5::Id file = h5::open_file(path, h5::Access::read);
        return h5::text_attribute(file.raw(), "status") == "complete" &&
               h5::text_attribute(file.raw(), "case_id") == id;
    } catch (const Error&) {
        return false; // truncated or damaged: the case is recomputed
    }
}

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

std::vector<double> read_mean_square(const std::filesystem::path& path) {
    const h5::Id file = h5::open_file(path, h5::Access::read);
    return h5::read_all(h5::open_dataset(file.raw(), "mean/u_z_squared"));
}

} // namespace shearwake::storage
