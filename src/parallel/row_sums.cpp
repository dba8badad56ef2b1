// SPDX-License-Identifier: BSD-3-Clause
#include "parallel/row_sums.hpp"

#include <numeric>

namespace shearwake {

double RowSums::mine() const {
    return std::accumulate(rows_.begin(), rows_.end(), 0.0);
}

double RowSums::of(const Comm& team) const {
    RowSums all = *this;
    team.sum(std::span<double>(all.rows_)); // exact: all ranks but one add 0
    return all.mine();
}

} // namespace shearwake
