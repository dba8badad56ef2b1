// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/volume.hpp"
#include "storage/hdf5/h5.hpp"

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace shearwake::storage {

/// Metadata and scalars of a complete case file, without series and fields.
struct CaseSummary {
    std::map<std::string, std::string> texts; // root attributes that are text
    std::map<std::string, double> numbers;    // root attributes that are numbers
    std::vector<Variable> scalars;            // in the order of the file
    std::vector<Variable> shapes; // the other variables of the root group, without their values
};

/// Throws Error with the reason if the file is truncated, damaged or not a case file; its checksum
/// is verified first. Not collective.
CaseSummary read_case_summary(const std::filesystem::path& path);
/// Reads the file without verifying the checksum: HDF5 may crash on a damaged file, and with it
/// this process.
CaseSummary read_unverified_summary(const std::filesystem::path& path);

/// Whether the file exists, can be opened, is complete and belongs to the case with that id.
bool is_complete(const std::filesystem::path& path, const std::string& id);

/// Reads the stored surfaces of a complete case file. Does not verify the checksum
/// (read_case_summary does). Throws FileFailure. Not collective.
class SurfaceReader {
public:
    explicit SurfaceReader(const std::filesystem::path& path);

    /// u_z [m] of one stored time and depth: rows of constant x, nx times ny values.
    void read(std::size_t time, std::size_t depth, std::span<double> u_z_m) const;
    std::size_t times() const { return shape_.at(0); }

private:
    h5::Id file_, field_;
    std::vector<hsize_t> shape_; // time, depth, x, y
};

/// u_z(t) [m] of the first trace of a complete case file. Does not verify the checksum. Throws
/// FileFailure. Not collective.
std::vector<double> read_first_trace(const std::filesystem::path& path);

/// The time mean of u_z^2 [m^2] on the surface, row-major, of a complete case file. Does not verify
/// the checksum. Throws FileFailure if it was not recorded. Not collective.
std::vector<double> read_mean_square(const std::filesystem::path& path);

} // namespace shearwake::storage
