// SPDX-License-Identifier: BSD-3-Clause
#include "storage/hdf5/h5.hpp"

#include "parallel/agree.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <hdf5_hl.h>
#include <mpi.h>
#include <optional>
#include <utility>

namespace shearwake::h5 {
namespace {

void be_quiet() {
    // Errors become exceptions; the library would otherwise also print them on every rank.
    static const bool once = (H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr), true);
    (void)once;
}

Id property(hid_t kind) {
    return Id(H5Pcreate(kind), H5Pclose, "create a property list");
}

Id text_type(std::size_t length) {
    Id type(H5Tcopy(H5T_C_S1), H5Tclose, "copy a type");
    check(H5Tset_size(type.raw(), std::max<std::size_t>(length, 1)), "size a type");
    check(H5Tset_cset(type.raw(), H5T_CSET_UTF8), "set the character set of a type");
    return type;
}

void write_attribute(hid_t object, const std::string& name, hid_t type, const void* value) {
    static const Id& space = *new Id(H5Screate(H5S_SCALAR), H5Sclose, "create a dataspace");
    const Id attribute(
        H5Acreate2(object, name.c_str(), type, space.raw(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
        "create attribute " + name);
    check(H5Awrite(attribute.raw(), type, value), "write attribute " + name);
}

/// "No space left on device" out of "file write failed: time = ..., error message = '...', buf
/// ...".
std::optional<std::string> system_reason(const std::string& message) {
    constexpr std::string_view before = "error message = '";
    const auto found = message.find(before);
    if (found == std::string::npos) return std::nullopt;
    const auto begin = found + before.size();
    return message.substr(begin, message.find('\'', begin) - begin);
}

/// The attribute must be a single value.
void require_single_value(const Id& attribute, const std::string& name) {
    const Id space(H5Aget_space(attribute.raw()), H5Sclose, "inspect attribute " + name);
    if (H5Sget_simple_extent_npoints(space.raw()) != 1)
        throw Error("attribute " + name + " is not a single value");
}

/// Classifies the message of HDF5, which ends in that of the operating system, if any. MPI gives no
/// reason.
Persistence persistence_of_words(const std::string& reason) {
    for (const int error : {ENOSPC, EDQUOT, EROFS, EACCES, EPERM, ENOENT, ENOTDIR, EISDIR, EFBIG})
        if (reason.ends_with(std::strerror(error))) return Persistence::lasting;
    return Persistence::passing;
}

} // namespace

std::string last_error() {
    std::string message;
    H5Ewalk2(
        H5E_DEFAULT, H5E_WALK_UPWARD,
        [](unsigned n, const H5E_error2_t* error, void* out) -> herr_t {
            if (n == 0 && error->desc) *static_cast<std::string*>(out) = error->desc;
            return 0;
        },
        &message);
    H5Eclear2(H5E_DEFAULT);
    return system_reason(message).value_or(message);
}

void check_together(herr_t status, const std::string& what, const Comm& comm) {
    const std::string reason = status < 0 ? last_error() : "";
    const bool passing = persistence_of_words(reason) == Persistence::passing;
    const int worst = comm.max(status >= 0 ? 0 : passing ? 1 : 2);
    if (worst != 0)
        throw FileFailure(fmt::format("HDF5 cannot {} {}", what, reason),
                          worst == 1 ? Persistence::passing : Persistence::lasting);
}

void check(herr_t status, const std::string& what) {
    if (status >= 0) return;
    const std::string reason = last_error();
    throw FileFailure(fmt::format("HDF5 cannot {}: {}", what, reason),
                      persistence_of_words(reason));
}

void never_tidy_up() {
    H5dont_atexit();
    H5open();
}

Id::Id(hid_t raw, Close closer, const std::string& what) : raw_(raw), close_(closer) {
    if (raw < 0) check(-1, what);
}

Id::~Id() {
    if (raw_ < 0) return;
    if (!is_shared_)
        close_(raw_);
    else if (close_ == H5Fclose)
        abandon_file(raw_);
}

Id::Id(Id&& other) noexcept
    : raw_(std::exchange(other.raw_, -1)), close_(other.close_), is_shared_(other.is_shared_) {}

Id& Id::operator=(Id&& other) noexcept {
    std::swap(raw_, other.raw_);
    std::swap(close_, other.close_);
    std::swap(is_shared_, other.is_shared_);
    return *this;
}

Id Id::shared() && {
    is_shared_ = true;
    return std::move(*this);
}

void Id::close(const std::string& what) {
    check(close_(std::exchange(raw_, -1)), what);
}

void Id::close_shared(const std::string& what, const Comm& comm) {
    comm.before_collective();
    const herr_t status = close_(std::exchange(raw_, -1));
    check_together(status, what + " on all ranks", comm);
}

Id open_file(const std::filesystem::path& path, Access access) {
    be_quiet();
    // Values are written immediately: errors of a buffer that is flushed when its dataset is closed
    // would not be reported.
    const Id unbuffered = property(H5P_FILE_ACCESS);
    check(H5Pset_sieve_buf_size(unbuffered.raw(), 0), "disable the sieve buffer");
    // Claims protect the files, also on file systems without locks.
    check(H5Pset_file_locking(unbuffered.raw(), false, true), "disable locks");
    // HDF5 would reserve blocks that it returns when the file is closed: its bytes would change
    // after a checkpoint has recorded them, and an image would be longer than the file.
    check(H5Pset_meta_block_size(unbuffered.raw(), 0), "reserve no metadata");
    check(H5Pset_small_data_block_size(unbuffered.raw(), 0), "reserve no data");
    if (access == Access::in_memory)
        check(H5Pset_fapl_core(unbuffered.raw(), std::size_t{1} << 16, false), "work in memory");
    else if (access != Access::create) {
        const unsigned flags = access == Access::read ? H5F_ACC_RDONLY : H5F_ACC_RDWR;
        Id file(H5Fopen(path.c_str(), flags, unbuffered.raw()), H5Fclose, "open " + path.string());
        if (access == Access::read) storage::require_self_contained(file.raw());
        return file;
    }
    // The order of creation is stored, as netCDF-4 readers expect.
    const Id creation = property(H5P_FILE_CREATE);
    check(H5Pset_link_creation_order(creation.raw(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED),
          "track order");
    return Id(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.raw(), unbuffered.raw()), H5Fclose,
              "create " + path.string());
}

std::string image_of(const Id& file) {
    check(H5Fflush(file.raw(), H5F_SCOPE_GLOBAL), "complete a file in memory");
    const ssize_t size = H5Fget_file_image(file.raw(), nullptr, 0);
    if (size < 0) check(-1, "find the size of a file in memory");
    std::string bytes(static_cast<std::size_t>(size), '\0');
    if (H5Fget_file_image(file.raw(), bytes.data(), bytes.size()) < 0)
        check(-1, "copy a file in memory");
    return bytes;
}

Id open_shared(const std::filesystem::path& path, const Comm& comm, Access access) {
    be_quiet();
    const Id properties = property(H5P_FILE_ACCESS);
    check(H5Pset_fclose_degree(properties.raw(), H5F_CLOSE_STRONG), "close files completely");
    const unsigned flags = access == Access::read ? H5F_ACC_RDONLY : H5F_ACC_RDWR;
    comm.before_collective();
    // The communicator is duplicated, and then the file is opened.
    const herr_t chosen = comm.size() == 1
                              ? H5Pset_file_locking(properties.raw(), false, true)
                              : H5Pset_fapl_mpio(properties.raw(), comm.raw(), MPI_INFO_NULL);
    const hid_t raw = chosen < 0 ? -1 : H5Fopen(path.c_str(), flags, properties.raw());
    Id file;
    if (raw >= 0) file = Id(raw, H5Fclose, {}).shared();
    check_together(raw < 0 ? -1 : 0, "open " + path.string() + " on all ranks", comm);
    return file;
}

Id open_group(hid_t parent, const std::string& name) {
    return Id(H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose, "open group " + name);
}

Id create_group(hid_t parent, const std::string& name) {
    const Id creation = property(H5P_GROUP_CREATE);
    check(H5Pset_link_creation_order(creation.raw(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED),
          "track order");
    return Id(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, creation.raw(), H5P_DEFAULT), H5Gclose,
              "create group " + name);
}

Id create_dataset(hid_t parent, const std::string& name, std::span<const hsize_t> shape,
                  const std::function<void()>& just_before) {
    const Id space(shape.empty()
                       ? H5Screate(H5S_SCALAR)
                       : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                   H5Sclose, "create a dataspace");
    // Created once, since a case has more than a hundred datasets, and never closed, since HDF5
    // may end before.
    static const Id& creation = *new Id([] {
        Id early = property(H5P_DATASET_CREATE);
        check(H5Pset_alloc_time(early.raw(), H5D_ALLOC_TIME_EARLY), "allocate early");
        check(H5Pset_fill_time(early.raw(), H5D_FILL_TIME_NEVER), "not fill");
        return early;
    }());
    const std::string what = "create dataset " + name;
    if (just_before) just_before();
    return Id(H5Dcreate2(parent, name.c_str(), H5T_NATIVE_DOUBLE, space.raw(), H5P_DEFAULT,
                         creation.raw(), H5P_DEFAULT),
              H5Dclose, what);
}

Id create_shared_dataset(const Id& file, const std::string& name, std::span<const hsize_t> shape,
                         const Comm& comm) {
    Id dataset;
    const auto create = [&] {
        return create_dataset(file.raw(), name, shape, [&] { comm.before_collective(); }).shared();
    };
    fail_together(comm, [&] { dataset = create(); });
    return dataset;
}

void flush_shared(const Id& file, const std::string& what, const Comm& comm) {
    comm.before_collective();
    check_together(H5Fflush(file.raw(), H5F_SCOPE_GLOBAL), what, comm);
}

Id open_dataset(hid_t parent, const std::string& name) {
    return Id(H5Dopen2(parent, name.c_str(), H5P_DEFAULT), H5Dclose, "open dataset " + name);
}

std::vector<hsize_t> shape(const Id& dataset) {
    const Id space(H5Dget_space(dataset.raw()), H5Sclose, "inspect the shape of a dataset");
    const int rank = H5Sget_simple_extent_ndims(space.raw());
    check(rank, "count dimensions");
    std::vector<hsize_t> extents(static_cast<std::size_t>(rank));
    check(H5Sget_simple_extent_dims(space.raw(), extents.data(), nullptr), "read extents");
    return extents;
}

void write_all(const Id& dataset, std::span<const double> values) {
    if (values.empty()) return;
    check(H5Dwrite(dataset.raw(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
          "write a dataset");
}

std::vector<double> read_all(const Id& dataset) {
    hsize_t count = 1;
    for (const hsize_t extent : shape(dataset))
        count *= extent;
    std::vector<double> values(count);
    if (count > 0)
        check(
            H5Dread(dataset.raw(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
            "read a dataset");
    return values;
}

void put_attribute(hid_t object, const std::string& name, const std::string& value) {
    if (value.size() > largest_text) throw Error("attribute " + name + " is too long");
    write_attribute(object, name, text_type(value.size()).raw(), value.c_str());
}

void put_attribute(hid_t object, const std::string& name, double value) {
    write_attribute(object, name, H5T_NATIVE_DOUBLE, &value);
}

void put_attribute(hid_t object, const std::string& name, long value) {
    write_attribute(object, name, H5T_NATIVE_LONG, &value);
}

bool has_attribute(hid_t object, const std::string& name) {
    return H5Aexists(object, name.c_str()) > 0;
}

std::string text_attribute(hid_t object, const std::string& name) {
    const Id attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose,
                       "open attribute " + name);
    const Id type(H5Aget_type(attribute.raw()), H5Tclose, "inspect attribute " + name);
    if (H5Tget_class(type.raw()) != H5T_STRING || H5Tis_variable_str(type.raw()) != 0)
        throw Error("attribute " + name + " is not a string of fixed length");
    require_single_value(attribute, name);
    const std::size_t size = H5Tget_size(type.raw());
    std::string value(size, '\0');
    check(H5Aread(attribute.raw(), type.raw(), value.data()), "read attribute " + name);
    value.resize(std::min(size, value.find('\0')));
    return value;
}

double number_attribute(hid_t object, const std::string& name) {
    const Id attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose,
                       "open attribute " + name);
    require_single_value(attribute, name);
    double value = 0.0;
    check(H5Aread(attribute.raw(), H5T_NATIVE_DOUBLE, &value), "read attribute " + name);
    return value;
}

namespace {

hobj_ref_t reference_to(const Id& dataset) {
    hobj_ref_t reference{};
    check(H5Rcreate(&reference, dataset.raw(), ".", H5R_OBJECT, -1), "refer to a dataset");
    return reference;
}

void write_list(const Id& dataset, const char* name, const Id& type, hsize_t count,
                const void* values) {
    const Id space(H5Screate_simple(1, &count, nullptr), H5Sclose, "create a dataspace");
    const Id list(
        H5Acreate2(dataset.raw(), name, type.raw(), space.raw(), H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose, "create a list of scales");
    check(H5Awrite(list.raw(), type.raw(), values), "write a list of scales");
}

} // namespace

Scale::Scale(Id coordinate, const std::string& name) : coordinate_(std::move(coordinate)) {
    check(H5DSset_scale(coordinate_.raw(), name.c_str()), "create a dimension scale");
}

void Scale::write_uses() const {
    if (uses_.empty()) return;
    const Id type(H5Tcreate(H5T_COMPOUND, sizeof(Use)), H5Tclose, "create a type");
    check(H5Tinsert(type.raw(), "dataset", HOFFSET(Use, dataset), H5T_STD_REF_OBJ), "add a member");
    check(H5Tinsert(type.raw(), "dimension", HOFFSET(Use, dimension), H5T_NATIVE_INT),
          "add a member");
    write_list(coordinate_, "REFERENCE_LIST", type, uses_.size(), uses_.data());
}

void attach_scales(const Id& dataset, const std::vector<Scale*>& scales) {
    if (scales.empty()) return;
    std::vector<hobj_ref_t> references;
    std::vector<hvl_t> lists; // one scale per dimension
    references.reserve(scales.size());
    for (Scale* scale : scales) {
        scale->uses_.push_back({reference_to(dataset), static_cast<int>(lists.size())});
        references.push_back(reference_to(scale->coordinate_));
        lists.push_back({1, &references.back()});
    }
    const Id type(H5Tvlen_create(H5T_STD_REF_OBJ), H5Tclose, "create a type");
    write_list(dataset, "DIMENSION_LIST", type, lists.size(), lists.data());
}

void attach_scale(const Id& dataset, const Id& coordinate, unsigned dimension) {
    check(H5DSattach_scale(dataset.raw(), coordinate.raw(), dimension), "attach a dimension scale");
}

std::vector<std::string> dataset_names(hid_t group) {
    std::vector<std::string> names;
    const auto visit = [](hid_t parent, const char* name, const H5L_info_t*, void* out) -> herr_t {
        H5L_info_t link;
        if (H5Lget_info(parent, name, &link, H5P_DEFAULT) < 0) return -1;
        if (link.type == H5L_TYPE_EXTERNAL) return 0;
        H5O_info_t info;
        if (H5Oget_info_by_name(parent, name, &info, H5P_DEFAULT) < 0) return -1;
        if (info.type == H5O_TYPE_DATASET)
            static_cast<std::vector<std::string>*>(out)->emplace_back(name);
        return 0;
    };
    if (H5Literate(group, H5_INDEX_CRT_ORDER, H5_ITER_INC, nullptr, visit, &names) >= 0)
        return names;
    names.clear(); // files of other programs may not store the order of creation
    check(H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, &names), "list a group");
    return names;
}

std::string library_version() {
    unsigned major = 0, minor = 0, release = 0;
    H5get_libversion(&major, &minor, &release);
    return fmt::format("{}.{}.{}", major, minor, release);
}

} // namespace shearwake::h5
