// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "measures/surface_sums.hpp"

#include <span>

namespace shearwake::measures {

/// Sums for the `_period_` columns: numerators and denominators of the surface measures, each
/// summed over time with the weights of the window (window.hpp) BEFORE division. Angle brackets:
/// the weighted sum over frames.
struct PeriodSums {
    double u_squared = 0.0;     // < (sum u)^2 >
    double abs_u_squared = 0.0; // < (sum |u|)^2 >
    double u2 = 0.0;            // < sum u^2 >
    double u2_squared = 0.0;    // < (sum u^2)^2 >
    double u4 = 0.0;            // < sum u^4 >
    double focal_u2 = 0.0;      // < sum w u^2 >
    double focal_weight = 0.0;  // < sum w >
    double weight = 0.0;        // < 1 >, in frames
};

/// `weights` has one entry per frame; frames of weight 0 are ignored.
PeriodSums period_sums(std::span<const SurfaceSums> frames, std::span<const double> weights);

/// The fraction of the area of the focal discs that lies inside the measured region, averaged over
/// the frames with these weights. Not collective.
double focal_share(const Case& c, std::span<const SurfaceSums> frames,
                   std::span<const double> weights);

} // namespace shearwake::measures
