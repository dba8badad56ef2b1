// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace shearwake {

/// A sum over rows, each of which belongs to one rank. It is accumulated in the order of the rows,
/// so that the result has the same bits on any number of ranks.
class RowSums {
public:
    explicit RowSums(std::ptrdiff_t rows = 0) : rows_(static_cast<std::size_t>(rows), 0.0) {}

    void clear() { std::fill(rows_.begin(), rows_.end(), 0.0); }
    void add(std::ptrdiff_t row, double value) { rows_[static_cast<std::size_t>(row)] += value; }
    /// Sum over the rows of this rank. Not collective.
    double mine() const;
    /// Sum over the rows of all ranks. Collective.
    double of(const Comm& team) const;

private:
    std::vector<double> rows_;
};

} // namespace shearwake
