// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"
#include "storage/hdf5/guard.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <hdf5.h>
#include <new>
#include <span>
#include <string>
#include <vector>

namespace shearwake::h5 {

/// Owner of an HDF5 identifier. A failed call throws FileFailure with the innermost message of
/// HDF5. An object that all ranks of a team have open is closed by close_shared() only: closing is
/// collective, so the destructor abandons it when a failure has left it open (guard.hpp).
class Id {
public:
    using Close = herr_t (*)(hid_t);
    Id() = default;
    Id(hid_t raw, Close closer, const std::string& what);
    ~Id();
    Id(Id&& other) noexcept;
    Id& operator=(Id&& other) noexcept;

    hid_t raw() const { return raw_; }
    /// The same object as one that all ranks have open. Not collective.
    Id shared() &&;
    /// Closes with a check, unlike the destructor: closing can fail, for example on a full disk.
    void close(const std::string& what);
    /// Closes an object that all ranks have open. Collective; throws FileFailure on all of them.
    void close_shared(const std::string& what, const Comm& comm);

private:
    hid_t raw_ = -1;
    Close close_ = nullptr;
    bool is_shared_ = false;
};

/// Call before MPI starts. Disables the cleanup of HDF5 1.10 at exit, which crashes on files that
/// could not be written or closed. Objects that are open at exit are not closed.
void never_tidy_up();

/// Throws FileFailure with `what` and HDF5's message if `status` is negative.
void check(herr_t status, const std::string& what);
/// Throws on all ranks if `status` is negative on any. Collective.
void check_together(herr_t status, const std::string& what, const Comm& comm);

/// The innermost description on HDF5's error stack; clears it.
std::string last_error();

/// in_memory: created without a file; its bytes are obtained from image_of().
enum class Access { create, read_write, read, in_memory };

/// A file through the ordinary driver. Not collective.
Id open_file(const std::filesystem::path& path, Access access);
/// An existing file through MPI, or the ordinary driver on one rank. Collective; throws FileFailure
/// on all ranks together. Collective calls on such files go through the functions for shared
/// objects and h5_block.hpp.
Id open_shared(const std::filesystem::path& path, const Comm& comm,
               Access access = Access::read_write);

/// The bytes of a file that is open in memory.
std::string image_of(const Id& file);

Id open_group(hid_t parent, const std::string& name);
Id create_group(hid_t parent, const std::string& name);
/// Contiguous doubles with early allocation. `just_before` is called when only the call of HDF5
/// remains.
Id create_dataset(hid_t parent, const std::string& name, std::span<const hsize_t> shape,
                  const std::function<void()>& just_before = {});
/// As create_dataset(), in a file that all ranks have open. Collective; throws FileFailure on all
/// of them.
Id create_shared_dataset(const Id& file, const std::string& name, std::span<const hsize_t> shape,
                         const Comm& comm);
/// Writes all buffers of a file that all ranks have open. Collective; throws FileFailure on all of
/// them.
void flush_shared(const Id& file, const std::string& what, const Comm& comm);
Id open_dataset(hid_t parent, const std::string& name);
std::vector<hsize_t> shape(const Id& dataset);
void write_all(const Id& dataset, std::span<const double> values);
std::vector<double> read_all(const Id& dataset);

/// The compact storage of an attribute is limited to 64 KiB; longer text is an error.
inline constexpr std::size_t largest_text = 60000;
void put_attribute(hid_t object, const std::string& name, const std::string& value);
void put_attribute(hid_t object, const std::string& name, double value);
void put_attribute(hid_t object, const std::string& name, long value);
bool has_attribute(hid_t object, const std::string& name);
std::string text_attribute(hid_t object, const std::string& name);
double number_attribute(hid_t object, const std::string& name);

/// Attaches a coordinate, which is a dimension scale, to a dimension.
void attach_scale(const Id& dataset, const Id& coordinate, unsigned dimension);

/// A coordinate as a new dimension scale, with the same attributes as attach_scale() writes (HDF5
/// Dimension Scale Specification). attach_scale() reads and rewrites them for every dimension,
/// which was a quarter of the time to write a small case file.
class Scale {
public:
    Scale(Id coordinate, const std::string& name);
    const Id& dataset() const { return coordinate_; }
    /// Writes the list of the dimensions to which the scale is attached. Call once, after all
    /// attach_scales().
    void write_uses() const;

private:
    friend void attach_scales(const Id& dataset, const std::vector<Scale*>& scales);
    struct Use {
        hobj_ref_t dataset;
        int dimension;
    };
    Id coordinate_;
    std::vector<Use> uses_;
};
/// Attaches a scale to each dimension of a dataset, or none if the list is empty.
void attach_scales(const Id& dataset, const std::vector<Scale*>& scales);

/// Names of the datasets of a group in order of creation, or in alphabetical order if it is not
/// stored.
std::vector<std::string> dataset_names(hid_t group);

std::string library_version();

} // namespace shearwake::h5

namespace shearwake::storage {

/// Returns the result of `read` for the HDF5 file of a user. All errors are UsageErrors that begin
/// with the name of the file. Not collective.
template <class Read>
auto read_user_file(const std::filesystem::path& path, Read read) {
    const std::string name = path.string();
    if (!std::filesystem::is_regular_file(path))
        throw UsageError(
            name + (std::filesystem::exists(path) ? " is not a regular file" : " does not exist"));
    try {
        const h5::Id file = h5::open_file(path, h5::Access::read);
        return read(file.raw());
    } catch (const std::bad_alloc&) {
        throw UsageError(name + ": it does not fit into the memory of this machine");
    } catch (const UsageError& problem) {
        throw UsageError(fmt::format("{}: {}", name, problem.what()));
    } catch (const Error& problem) {
        throw UsageError(fmt::format("{}: it cannot be read as HDF5: {}", name, problem.what()));
    }
}

} // namespace shearwake::storage
