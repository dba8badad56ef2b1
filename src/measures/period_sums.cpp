// SPDX-License-Identifier: BSD-3-Clause
#include "measures/period_sums.hpp"

#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

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
        sums.focal_weight += weight * frame.focal_weight;
        sums.weight += weight;
    }
    return sums;
}

double focal_share(const Case& c, std::span<const SurfaceSums> frames,
                   std::span<const double> weights) {
    const Region region = measured_region(c.domain, c.measure);
    const double radius_m = c.measure.focal_radius_m,
                 disc_cells = std::numbers::pi * std::pow(radius_m / c.domain.spacing_m, 2);
    double inside = 0.0, all = 0.0;
    for (std::size_t n = 0; n < frames.size(); ++n) {
        if (weights[n] == 0.0) continue;
        const std::vector<Vec2> places =
            foci(c.scene().load.modulation, c.time.frame_s(static_cast<std::ptrdiff_t>(n)));
        const double complete = disc_cells * static_cast<double>(places.size());
        double cells = frames[n].focal_weight;
        if (places.size() > 1 && cells < (1.0 - 1e-9) * complete) { // discs that overlap, too
            cells = 0.0;
            for (const Vec2& place : places) {
                const FocalRegion disc(c.domain, region, std::span(&place, 1), radius_m);
                for (std::ptrdiff_t i = disc.x_first; i < disc.x_end; ++i)
                    disc.row(i, [&](std::ptrdiff_t, double w) { cells += w; });
            }
        }
        inside += weights[n] * cells;
        all += weights[n] * complete;
    }
    return inside / all;
}

} // namespace shearwake::measures
