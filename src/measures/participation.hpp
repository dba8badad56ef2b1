// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "measures/surface_sums.hpp"
#include "measures/window.hpp"

namespace shearwake::measures {

// Measures of the area over which a displacement is spread, as numbers of samples; multiplied by
// spacing^2, they are areas that do not depend on the grid. All increase with spread. NaN: nothing
// has moved.

/// (sum u)^2 / sum u^2: the inverse participation ratio as the thesis defines it. In nearly
/// incompressible tissue sum u is almost 0 (volume is conserved): it measures compressibility
/// rather than spread.
inline double ipr(const SurfaceSums& sums) {
    return sums.u * sums.u / sums.u2;
}

/// (sum |u|)^2 / sum u^2: the participation of the absolute displacement.
inline double ipr_abs(const SurfaceSums& sums) {
    return sums.abs_u * sums.abs_u / sums.u2;
}

/// (sum u^2)^2 / sum u^4: the participation of the squared displacement.
inline double participation(const SurfaceSums& sums) {
    return sums.u2 * sums.u2 / sums.u4;
}

/// sum_t (sum u)^2 / sum_t sum u^2.
inline double ipr(const PeriodSums& sums) {
    return sums.u_squared / sums.u2;
}

/// sum_t (sum |u|)^2 / sum_t sum u^2.
inline double ipr_abs(const PeriodSums& sums) {
    return sums.abs_u_squared / sums.u2;
}

/// sum_t (sum u^2)^2 / sum_t sum u^4.
inline double participation(const PeriodSums& sums) {
    return sums.u2_squared / sums.u4;
}

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
