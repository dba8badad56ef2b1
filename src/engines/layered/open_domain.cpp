// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/open_domain.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::layered {
namespace {

/// Where a Gaussian has fallen to 3e-8 of its peak, in widths (FWHM).
constexpr double gaussian_reach_fwhm = 2.5;
constexpr double fewest_samples = 4000.0; // of the path

/// The largest |x| and |y| of the load within the run.
Vec2 extent_of_load_m(const Case& c) {
    const Load& load = c.scene().load;
    const double end_s = std::min(c.time.duration_s(), off_time_s(load.modulation.trajectory));
    const double steps = std::max(fewest_samples, static_cast<double>(c.time.frames));
    Vec2 most;
    for (double n = 0.0; n <= steps; ++n)
        for (const Vec2 focus : foci(load.modulation, end_s * n / steps))
            most = {std::max(most.x, std::abs(focus.x)), std::max(most.y, std::abs(focus.y))};
    const double around =
        reach_m(load.footprint).value_or(gaussian_reach_fwhm * fwhm_m(load.footprint));
    return most + Vec2{around, around};
}

std::ptrdiff_t enlarged(std::ptrdiff_t points, double spacing_m, double load_m) {
    const double extent = static_cast<double>(points);
    const double eighths = std::ceil(8.0 + 16.0 * load_m / (spacing_m * extent) - 1e-9);
    return good_even_length(
        static_cast<std::ptrdiff_t>(std::ceil(extent * std::min(eighths, 16.0) / 8.0)));
}

} // namespace

Domain solved_domain(const Case& c) {
    Domain solved = c.domain;
    if (c.domain.edges != DomainEdges::open || c.study()) return solved;
    const Vec2 load_m = extent_of_load_m(c);
    solved.nx = enlarged(c.domain.nx, c.domain.spacing_m, load_m.x);
    solved.ny = enlarged(c.domain.ny, c.domain.spacing_m, load_m.y);
    return solved;
}

Case solved_case(const Case& c) {
    Case solved = c;
    solved.domain = solved_domain(c);
    return solved;
}

InnerRows inner_rows(const Domain& domain, const Domain& solved, const fft::SlabShare& share) {
    const std::ptrdiff_t below_x = (solved.nx - domain.nx) / 2,
                         below_y = (solved.ny - domain.ny) / 2;
    const auto row = [&](std::ptrdiff_t solved_row) {
        return std::clamp<std::ptrdiff_t>(solved_row - below_x, 0, domain.nx);
    };
    const std::ptrdiff_t first = row(share.x_start), end = row(share.x_start + share.x_count);
    if (end <= first) return {.x_start = first, .x_count = 0, .offset = 0};
    return {.x_start = first,
            .x_count = end - first,
            .offset = (first + below_x - share.x_start) * share.padded_ny + below_y};
}

} // namespace shearwake::layered
