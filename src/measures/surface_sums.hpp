#pragma once

#include "base/vec2.hpp"
#include "base/view.hpp"
#include "model/case.hpp"

#include <cstddef>
#include <span>

namespace shearwake {

/// What every surface measure is made of: sums over the samples of the measured region of one
/// frame, or of the rows of it that one slab holds. u in m; the focal sums over the focal disc,
/// each sample weighted by the fraction w of its cell inside the disc. A NaN in the frame makes
/// the sums NaN.
struct SurfaceSums {
    double u = 0.0;            // sum u [m]
    double abs_u = 0.0;        // sum |u| [m]
    double u2 = 0.0;           // sum u^2 [m^2]
    double u4 = 0.0;           // sum u^4 [m^4]
    double focal_u2 = 0.0;     // sum w u^2 [m^2]
    double focal_weight = 0.0; // sum w, in samples
    double peak = 0.0;         // max |u| [m]
    double focal_peak = 0.0;   // max |u| where w > 0 [m]
    bool operator==(const SurfaceSums&) const = default;
};

/// Samples [x0, x1) x [y0, y1) of the global grid.
struct Region {
    std::ptrdiff_t x0 = 0, x1 = 0, y0 = 0, y1 = 0;
    bool operator==(const Region&) const = default;
};

/// The region that is measured: the whole plane inside the sponge. A sample belongs to it when it
/// is at least the sponge's width away from both edges of the domain, [-extent/2, extent/2).
Region measured_region(const Domain& domain);

/// Partial sums of the slab whose row i is the global row x_start + i and whose columns are all of
/// y. The disc does not wrap around the periodic domain and is cut off at the region's edge.
/// Not collective. Row sums do not depend on the slab, and rows are added with compensation, so
/// that however the rows are cut the combined sums agree to a few rounding errors of the largest
/// partial sum: the signed sum too, of which little is left (volume is conserved).
SurfaceSums surface_sums(View2<const double> slab, std::ptrdiff_t x_start, const Domain& domain,
                         const Region& region, Vec2 focus_m, double focal_radius_m);

/// The same with the focal region about several foci: w is the sum over their discs, at most 1
/// (where two overlap within one cell this is a little more than the part inside either).
SurfaceSums surface_sums(View2<const double> slab, std::ptrdiff_t x_start, const Domain& domain,
                         const Region& region, std::span<const Vec2> foci_m, double focal_radius_m);

/// Sums add, peaks are the larger one.
SurfaceSums combine(const SurfaceSums& a, const SurfaceSums& b);

} // namespace shearwake
