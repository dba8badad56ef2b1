#pragma once

#include <cstddef>
#include <hdf5.h>
#include <string>
#include <vector>

namespace shearwake {

/// Numbers of a file that others wrote, in row-major order.
struct NumberBlock {
    std::vector<std::size_t> shape; // none: a single number
    std::vector<double> values;
};

/// A dataset of any number type, compressed or not, of at most 2^28 numbers. Not collective. Throws
/// UsageError when it is missing, holds no numbers or is too large; Error when it cannot be read.
NumberBlock read_numbers(hid_t file, const std::string& path);

} // namespace shearwake
