// SPDX-License-Identifier: BSD-3-Clause
#include "measures/period_sums.hpp"

#include <cassert>

namespace shearwake::measures {

PeriodSums period_sums(std::span<const SurfaceSums> frames, std::span<const double> weights) {
    assert(frames.size() == weights.size());
    PeriodSums sums;
    for (std::size_t n = 0; n < frames.size(); ++n) {
        const double weight = weights[n];
        if (weight == 0.0) continue;
        const SurfaceSums& frame = frames[n];
        sums.u_squared += weight * frame.u * frame.u;
        sums.abs_u_squared += weight * frame.abs_u * frame.abs_u;
        sums.u2 += weight * frame.u2;
        sums.u2_squared += weight * frame.u2 * frame.u2;
        sums.u4 += weight * frame.u4;
        sums.focal_u2 += weight * frame.focal_u2;
        sums.focal_mean_u2 += weight * (frame.focal_u2 / frame.focal_weight); // 0/0: NaN, meant
        sums.weight += weight;
    }
    return sums;
}

} // namespace shearwake::measures
