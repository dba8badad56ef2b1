// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"
#include "base/view.hpp"
#include "problem/case/case.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace shearwake::measures {

/// Sums from which all surface measures are computed: over the samples of the measured region of
/// one frame, or over the rows of one slab. u in m; each sample is weighted by the fraction of its
/// cell inside the region, and in the focal sums by the fraction w inside the region and the focal
/// disc. If the frame contains NaN, the sums are NaN.
struct SurfaceSums {
    double u = 0.0;            // sum u [m]
    double abs_u = 0.0;        // sum |u| [m]
    double u2 = 0.0;           // sum u^2 [m^2]
    double u4 = 0.0;           // sum u^4 [m^4]
    double focal_u2 = 0.0;     // sum w u^2 [m^2]
    double focal_weight = 0.0; // sum w, in samples
    double peak = 0.0;         // max |u| [m]
    bool operator==(const SurfaceSums&) const = default;
};

/// How parts of a sum are combined, from the rows of the ranks and from parts of a run.
enum class Reduction { sum, max };
struct SumPart {
    double SurfaceSums::*value;
    Reduction reduction;
};
/// All sums, in the order of checkpoints.
inline constexpr std::array sum_parts = {
    SumPart{&SurfaceSums::u, Reduction::sum},
    SumPart{&SurfaceSums::abs_u, Reduction::sum},
    SumPart{&SurfaceSums::u2, Reduction::sum},
    SumPart{&SurfaceSums::u4, Reduction::sum},
    SumPart{&SurfaceSums::focal_u2, Reduction::sum},
    SumPart{&SurfaceSums::focal_weight, Reduction::sum},
    SumPart{&SurfaceSums::peak, Reduction::max},
};
static_assert(sizeof(SurfaceSums) == sum_parts.size() * sizeof(double), "a sum has no entry");

/// Consecutive samples [first, end) of a row with the same weight.
struct SampleRun {
    std::ptrdiff_t first = 0, end = 0;
    double weight = 1.0;
    bool operator==(const SampleRun&) const = default;
};

/// Samples [x0, x1) x [y0, y1) of the global grid, or those of them whose cells reach into a
/// polygon. The weight of a sample is the fraction of its cell inside, so that the area does not
/// depend on the grid.
struct Region {
    std::ptrdiff_t x0 = 0, x1 = 0, y0 = 0, y1 = 0;
    std::vector<std::vector<SampleRun>> cut = {}; // of rows x0 to x1 - 1; none: all of [y0, y1)
    bool operator==(const Region&) const = default;

    /// Calls f(first, end, weight) for each run of samples of the global row i, which is in
    /// [x0, x1).
    template <class F>
    void runs(std::ptrdiff_t i, F f) const {
        if (cut.empty()) return f(y0, y1, 1.0);
        for (const SampleRun& run : cut[static_cast<std::size_t>(i - x0)])
            f(run.first, run.end, run.weight);
    }
    std::ptrdiff_t samples() const;
    /// The sum of the weights: the area in cells.
    double cells() const;
};

/// The measured region: the whole plane inside the sponge. It includes all samples whose distance
/// from both edges of the domain, [-extent/2, extent/2), is at least the width of the sponge.
Region measured_region(const Domain& domain);
/// The cells, or parts of them, inside the polygon of the options, if they have one.
Region measured_region(const Domain& domain, const MeasureOptions& measure);
/// The corners of the measured region: of the polygon of the options, cut off at the sponge, or
/// without a sponge half a cell before the edges of the domain; without a polygon, the outer edges
/// of all measured cells. Empty if nothing is left.
std::vector<Vec2> measured_outline(const Domain& domain, const MeasureOptions& measure);

/// The samples of the measured region in the focal discs around all foci, each with its weight w:
/// the sum over the discs of the fraction of its cell inside, at most 1, times its weight in the
/// region. Refers to its arguments.
class FocalRegion {
public:
    FocalRegion(const Domain& domain, const Region& region, std::span<const Vec2> foci_m,
                double radius_m);

    std::ptrdiff_t x_first = 0, x_end = 0; // global rows
    /// Calls f(j, w) for each sample of the global row i with w > 0.
    template <class F>
    void row(std::ptrdiff_t i, F f) const {
        region_.runs(i, [&](std::ptrdiff_t first, std::ptrdiff_t end, double weight) {
            for (std::ptrdiff_t j = std::max(first, y_first_); j < std::min(end, y_end_); ++j)
                if (const double w = weight * fraction(i, j); w > 0.0) f(j, w);
        });
    }

private:
    double fraction(std::ptrdiff_t i, std::ptrdiff_t j) const;

    const Domain& domain_;
    const Region& region_;
    std::span<const Vec2> foci_m_;
    double radius_m_;
    std::ptrdiff_t y_first_ = 0, y_end_ = 0;
};

/// Partial sums of the slab whose row i is the global row x_start + i and whose columns are all of
/// y. The disc does not wrap around the periodic domain and ends at the edge of the region. Not
/// collective. Row sums do not depend on the slab, and rows are added with compensation.
/// Independent of the distribution of rows, the combined sums therefore agree to a few rounding
/// errors of the largest partial sum. This includes the signed sum, in which most contributions
/// cancel (volume is conserved).
SurfaceSums surface_sums(View2<const double> slab, std::ptrdiff_t x_start, const Domain& domain,
                         const Region& region, Vec2 focus_m, double focal_radius_m);

/// Partial sums with the focal region of several foci: w is the sum over their discs, at most 1
/// (where two overlap within one cell this is a little more than the part inside either).
SurfaceSums surface_sums(View2<const double> slab, std::ptrdiff_t x_start, const Domain& domain,
                         const Region& region, std::span<const Vec2> foci_m, double focal_radius_m);

/// Adds sums and takes the larger peaks.
SurfaceSums combine(const SurfaceSums& a, const SurfaceSums& b);

} // namespace shearwake::measures
