// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "storage/hdf5/h5.hpp"

#include <filesystem>
#include <span>
#include <vector>

namespace shearwake::storage {

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

} // namespace shearwake::storage
