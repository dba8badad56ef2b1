// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <hdf5.h>
#include <string>
#include <vector>

namespace shearwake::storage {

/// Values from a user file, in row-major order.
struct NumberBlock {
    std::vector<std::size_t> shape; // none: a single number
    std::vector<double> values;
};

/// Reads a dataset of any number type, compressed or not, with at most 2^28 values. Not collective.
/// Throws UsageError if it is missing, not numeric or too large, and Error if it cannot be read.
NumberBlock read_numbers(hid_t file, const std::string& path);

} // namespace shearwake::storage
