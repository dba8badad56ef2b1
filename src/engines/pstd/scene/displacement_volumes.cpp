// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scene/displacement_volumes.hpp"

#include <algorithm>
#include <array>

namespace shearwake::pstd {

DisplacementVolumes::DisplacementVolumes(const Case& c, const CaseGrid& grid, const Slabs& slabs)
    : c_(c), grid_(grid), slabs_(slabs), slab_(domain_slab(c, grid.first_x, slabs)) {
    if (c.record.volumes_s.empty()) return;
    for (const Field field : {Field::ux, Field::uy})
        lateral_.emplace_back(field, slabs, grid.surface, grid.levels);
}

std::vector<double> DisplacementVolumes::levels_m() const {
    std::vector<double> z_m;
    for (std::ptrdiff_t l = 0; l < grid_.levels && !lateral_.empty(); ++l)
        z_m.push_back(static_cast<double>(l) * grid_.spacing_m);
    return z_m;
}

template <class Real>
void DisplacementVolumes::add(const Stepper<Real>& stepper) {
    for (Displacement& u : lateral_)
        u.add(stepper);
}
template void DisplacementVolumes::add(const Stepper<double>&);
template void DisplacementVolumes::add(const Stepper<float>&);

/// Mean of x - 1/2 and x + 1/2; the row before the first one belongs to another rank.
DisplacementVolumes::Plane DisplacementVolumes::x_mean(const Plane& plane, const Comm& team) const {
    const auto ny = static_cast<std::size_t>(slabs_.ny());
    const std::size_t own = plane.empty() ? 0 : ny;
    const Plane last_rows = team.all_gather(std::span<const double>(plane).last(own));
    if (plane.empty()) return plane;
    std::size_t mine = 0; // position of this rank's row among them
    for (int r = 0; r < slabs_.rank; ++r)
        mine += slabs_.x_count(r) > 0 ? ny : 0;
    const double* before = last_rows.data() + (mine == 0 ? last_rows.size() : mine) - ny;
    Plane mean(plane.size());
    for (std::size_t i = 0; i < plane.size(); ++i)
        mean[i] = 0.5 * ((i < ny ? before[i] : plane[i - ny]) + plane[i]);
    return mean;
}

DisplacementVolumes::Plane DisplacementVolumes::y_mean(const Plane& plane) const {
    const auto ny = static_cast<std::size_t>(slabs_.ny());
    Plane mean(plane.size());
    for (std::size_t i = 0; i < plane.size(); ++i)
        mean[i] = 0.5 * (plane[i % ny == 0 ? i + ny - 1 : i - 1] + plane[i]);
    return mean;
}

void DisplacementVolumes::give(std::size_t snapshot, const Displacement& u_z,
                               engines::Observer& observer, const Comm& team) const {
    const std::ptrdiff_t ny = slabs_.ny();
    const std::ptrdiff_t first =
        slab_.x_count > 0 ? (slab_.x_start + grid_.first_x - slabs_.x_start()) * ny + grid_.first_y
                          : 0;
    Plane plane(static_cast<std::size_t>(slabs_.rows()));
    for (std::size_t component = 0; component < 3; ++component) {
        for (std::ptrdiff_t level = 0; level < grid_.levels && !lateral_.empty(); ++level) {
            if (component == 2) {
                u_z.sum(std::array{1.0}, plane, level);
            } else {
                const std::array at_skin = {1.5, -0.5}, between = {0.5, 0.5};
                lateral_[component].sum(level == 0 ? at_skin : between, plane,
                                        std::max<std::ptrdiff_t>(level - 1, 0));
                plane = component == 0 ? x_mean(plane, team) : y_mean(plane);
            }
            observer.volume({.snapshot = snapshot,
                             .field = 0,
                             .component = component,
                             .level = static_cast<std::size_t>(level),
                             .values = View2<const double>(plane.data() + first, slab_.x_count,
                                                           c_.domain.ny, ny)});
        }
    }
}

void DisplacementVolumes::save(StateWriter& state) const {
    for (std::size_t i = 0; i < lateral_.size(); ++i)
        lateral_[i].save(state, i == 0 ? "volume_u_x" : "volume_u_y");
}

void DisplacementVolumes::restore(const StateReader& state) {
    for (std::size_t i = 0; i < lateral_.size(); ++i)
        lateral_[i].restore(state, i == 0 ? "volume_u_x" : "volume_u_y");
}

} // namespace shearwake::pstd
