// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/recorder.hpp"
#include "kwave/input.hpp"
#include "parallel/comm.hpp"
#include "storage/hdf5/h5.hpp"

#include <span>
#include <string>

namespace shearwake::kwave {

/// An output file that rank 0 writes.
struct OutputFile {
    hid_t file = -1;
    bool doubles = false; // real numbers of 64 bits instead of 32
    int gzip_level = 0;
};

/// Creates a dataset of real numbers, or of unsigned integers of 64 bits, with k-Wave's attributes.
/// Not collective.
enum class Numbers { real, integer };
h5::Id create_dataset(const OutputFile& output, const std::string& name,
                      std::span<const hsize_t> shape, Numbers numbers);

/// Writes the records after the last step, in the layout of k-Wave: (1, samples, points) or one
/// dataset per cuboid, (samples, z, y, x); grids as (z, y, x). Collective.
template <class Real>
void write_records(const OutputFile& output, const pstd::Recorder& recorder, const Input& input,
                   const pstd::Stepper<Real>& stepper, const Comm& team);

} // namespace shearwake::kwave
