// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "measures/period_sums.hpp"
#include "measures/surface_sums.hpp"

namespace shearwake::measures {

/// eta = sum_focal w u^2 / sum u^2: the fraction of the squared displacement inside the focal disc.
/// Dimensionless, 0 to 1. NaN: nothing has moved.
inline double reconstruction_efficiency(const SurfaceSums& sums) {
    return sums.focal_u2 / sums.u2;
}

/// eta_period = sum_t sum_focal w u^2 / sum_t sum u^2.
inline double reconstruction_efficiency(const PeriodSums& sums) {
    return sums.focal_u2 / sums.u2;
}

} // namespace shearwake::measures
