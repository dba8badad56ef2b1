// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

#include <cstddef>
#include <cstdint>
#include <string>

namespace shearwake::storage {

/// A checksum of the rows of an array that does not depend on which rank holds which row: the sum,
/// modulo 2^64, of a hash of each row and its position. It detects accidental, not intentional
/// changes.
class RowChecksum {
public:
    void add(std::ptrdiff_t row, const double* values, std::ptrdiff_t length);
    /// The checksum over all ranks, as sixteen hexadecimal digits. Collective.
    std::string over(const Comm& comm) const;

private:
    std::uint64_t sum_ = 0;
};

} // namespace shearwake::storage
