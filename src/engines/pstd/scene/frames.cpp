// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scene/frames.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <string>

namespace shearwake::pstd {
namespace {

/// Why the field cannot be the solution: a displacement larger than the domain. Empty if it can.
std::string divergence(const Case& c, std::ptrdiff_t frame, double largest_m, double step_s) {
    const double domain_m = std::max(c.domain.extent_x_m(), c.domain.extent_y_m());
    if (largest_m <= domain_m) return "";
    const std::string what =
        std::isfinite(largest_m)
            ? fmt::format("diverges: the displacement of {:.3g} mm exceeds the size of the domain, "
                          "{:.4g} mm,",
                          1e3 * largest_m, 1e3 * domain_m)
            : std::string("is not finite");
    return fmt::format("the field of engine \"pstd\" {} at frame {}, {:.4g} ms: the time step of "
                       "{:.4g} us is probably unstable; a smaller {} may help",
                       what, frame, 1e3 * c.time.frame_s(frame), 1e6 * step_s,
                       c.study() ? "kgrid.dt of the study" : "solver.pstd.time_step_us");
}

} // namespace

engines::Slab domain_slab(const Case& c, std::ptrdiff_t first_x, const Slabs& slabs) {
    const auto inside = [&](std::ptrdiff_t x) {
        return std::clamp<std::ptrdiff_t>(x - first_x, 0, c.domain.nx);
    };
    const std::ptrdiff_t start = inside(slabs.x_start());
    return {start, inside(slabs.x_start() + slabs.x_count()) - start};
}

Frames::Frames(const Case& c, FramePlaces places, const Slabs& slabs)
    : c_(c), places_(std::move(places)), slabs_(slabs),
      slab_(domain_slab(c, places_.first_x, slabs)),
      u_z_(Field::uz, slabs, places_.first_z, places_.planes),
      plane_m_(static_cast<std::size_t>(slabs.rows())) {}

void Frames::give(std::ptrdiff_t number, engines::Observer& observer, const Comm& team) {
    const std::string why = divergence(c_, number, u_z_.largest_m(team), slabs_.grid.dt_s);
    if (!why.empty()) throw FieldDiverges(why);
    const std::ptrdiff_t ny = slabs_.ny(),
                         first = slab_.x_start + places_.first_x - slabs_.x_start();
    const double* values = plane_m_.data() + (slab_.x_count > 0 ? first * ny + places_.first_y : 0);
    for (std::size_t d = 0; d < places_.weights.size(); ++d) {
        u_z_.sum(places_.weights[d], plane_m_);
        observer.frame({.number = number,
                        .depth = d,
                        .u_z_m = View2<const double>(values, slab_.x_count, c_.domain.ny, ny)});
    }
}

} // namespace shearwake::pstd
