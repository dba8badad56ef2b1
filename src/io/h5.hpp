#pragma once

#include "parallel/comm.hpp"

#include <filesystem>
#include <hdf5.h>
#include <span>
#include <string>
#include <vector>

namespace shearwake::h5 {

/// Owner of any HDF5 identifier. A failed call throws FileFailure with HDF5's own innermost
/// message.
class Id {
public:
    using Close = herr_t (*)(hid_t);
    Id() = default;
    Id(hid_t raw, Close closer, const std::string& what);
    ~Id();
    Id(Id&& other) noexcept;
    Id& operator=(Id&& other) noexcept;

    hid_t raw() const { return raw_; }
    /// Closing can fail (a full disk shows here): checked, unlike in the destructor.
    void close(const std::string& what);
    /// The same for what all ranks have open. Collective; throws FileFailure on all of them
    /// together.
    void close_shared(const std::string& what, const Comm& comm);

private:
    hid_t raw_ = -1;
    Close close_ = nullptr;
};

/// To be called before MPI starts. At the end of a program HDF5 1.10 tidies up and falls over files
/// that it could not write or close; so it does not. What is open then is not closed.
void never_tidy_up();

/// Throws FileFailure with `what` and HDF5's message if `status` is negative.
void check(herr_t status, const std::string& what);
/// The same on all ranks together if it is on any. Collective.
void check_together(herr_t status, const std::string& what, const Comm& comm);

/// The innermost description on HDF5's error stack; clears it.
std::string last_error();

enum class Access { create, read_write, read };

/// A file through the ordinary driver. Not collective.
Id open_file(const std::filesystem::path& path, Access access);
/// An existing file through MPI. Collective; throws FileFailure on all ranks together.
Id open_shared(const std::filesystem::path& path, const Comm& comm,
               Access access = Access::read_write);

Id open_group(hid_t parent, const std::string& name);
Id create_group(hid_t parent, const std::string& name);
/// Contiguous doubles, allocated at once.
Id create_dataset(hid_t parent, const std::string& name, std::span<const hsize_t> shape);
Id open_dataset(hid_t parent, const std::string& name);
std::vector<hsize_t> shape(const Id& dataset);
void write_all(const Id& dataset, std::span<const double> values);
std::vector<double> read_all(const Id& dataset);

/// An attribute's compact storage takes 64 KiB; longer text is an error.
inline constexpr std::size_t largest_text = 60000;
void put_attribute(hid_t object, const std::string& name, const std::string& value);
void put_attribute(hid_t object, const std::string& name, double value);
void put_attribute(hid_t object, const std::string& name, long value);
bool has_attribute(hid_t object, const std::string& name);
std::string text_attribute(hid_t object, const std::string& name);
double number_attribute(hid_t object, const std::string& name);
std::vector<std::string> attribute_names(hid_t object);

/// The dataset becomes the coordinate of a dimension; another one is tied to it.
void make_scale(const Id& coordinate, const std::string& name);
void attach_scale(const Id& dataset, const Id& coordinate, unsigned dimension);

/// Names of the datasets of a group, in order of creation; of the alphabet if none is kept.
std::vector<std::string> dataset_names(hid_t group);

std::string library_version();

} // namespace shearwake::h5
