// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/depth/work_kinds.hpp"
#include "engines/spectral/stepping/stepper.hpp"

#include <algorithm>

namespace shearwake::spectral {

void Stepper::assemble_box() {
    // With rigid bodies the response depends on the positions of both cells.
    if (!solver_ || !bodies_->empty() || !slab_bodies_.empty()) return;
    const std::optional<BoxGrid> grid =
        box_grid(case_.domain, field_.cells().extent(team_),
                 {.planes = static_cast<double>(planes_->count()),
                  .factor_entries = static_cast<double>(operator_.factor_size()),
                  .steps = case_.time.duration_s() / step_s_});
    if (!grid) return;
    box_.emplace(field_, *grid, slabs_, team_, clock_);
    box_->assemble(
        [&](std::ptrdiff_t plane, StrainPlanes& planes) { respond_to_plane(plane, planes); });
}

void Stepper::respond_to_plane(std::ptrdiff_t plane, StrainPlanes& planes) {
    const engines::Timed timed(kinds::of_iteration);
    const std::ptrdiff_t components = transfer_.components(), pitch = 2 * slabs_.nx();
    const StrainPoint& point = transfer_.points()[static_cast<std::size_t>(plane / components)];
    const StrainTransfer one(mesh_, {point}, static_cast<int>(components), vectors_);
    std::vector<double> unit(static_cast<std::size_t>(components * pitch), 0.0);
    for (std::ptrdiff_t i = 0; i < slabs_.nx(); ++i)
        unit[static_cast<std::size_t>(plane % components * pitch + 2 * i)] = 1.0;
    const double per_point = 1.0 / static_cast<double>(case_.domain.nx * case_.domain.ny);
    Block* force = pencil_.data();
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        if (vectors_.is_nyquist(row)) {
            planes.end_row(row, StrainPlanes::Modes::emptied);
            continue;
        }
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
            std::fill(pencil_.begin(), pencil_.end(), Block{});
            one.add_force(row, block, unit.data(), pitch, per_point, force);
            operator_.solve_implicit(factor(row * vectors_.blocks() + block), force);
            const engines::Timed strains(planes.kind());
            transfer_.strain(row, block, force, planes.line(row), planes.stride());
        }
        planes.end_row_from(row, plane);
    }
}

} // namespace shearwake::spectral
