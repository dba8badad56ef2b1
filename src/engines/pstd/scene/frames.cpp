// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scene/frames.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::pstd {

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
    if (!u_z_.finite(team))
        throw FieldDiverges(fmt::format("the field of engine \"pstd\" is not finite at frame {}: a "
                                        "smaller time step may help",
                                        number));
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
