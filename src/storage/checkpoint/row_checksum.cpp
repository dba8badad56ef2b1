// SPDX-License-Identifier: BSD-3-Clause
#include "storage/checkpoint/row_checksum.hpp"

#include "base/hash.hpp"

#include <array>
#include <bit>

namespace shearwake::storage {

void RowChecksum::add(std::ptrdiff_t row, const double* values, std::ptrdiff_t length) {
    // The odd multiplier of splitmix64 (Steele, Lea, Flood 2014), each word mixed in turn.
    constexpr std::uint64_t odd = 0x9e3779b97f4a7c15ULL;
    std::uint64_t hash = (static_cast<std::uint64_t>(row) + 1) * odd;
    for (std::ptrdiff_t i = 0; i < length; ++i)
        hash = (std::rotl(hash, 23) ^ std::bit_cast<std::uint64_t>(values[i])) * odd;
    sum_ += hash ^ (hash >> 31);
}

std::string RowChecksum::over(const Comm& comm) const {
    // Sums of 32-bit halves are exact in doubles for up to two million ranks.
    std::array<double, 2> halves = {static_cast<double>(sum_ & 0xffffffffULL),
                                    static_cast<double>(sum_ >> 32)};
    comm.sum(halves);
    return hex(static_cast<std::uint64_t>(halves[0]) +
               (static_cast<std::uint64_t>(halves[1]) << 32));
}

} // namespace shearwake::storage
