// SPDX-License-Identifier: BSD-3-Clause
#include "engines/springs/springs_engine.hpp"

#include "base/units.hpp"
#include "base/view.hpp"
#include "problem/case/case.hpp"
#include "problem/load/load.hpp"
#include "parallel/comm.hpp"

#include <cstddef>

namespace shearwake::springs {

engines::Resources SpringsEngine::resources(const Case& c, int ranks) const {
    const auto points = static_cast<double>(c.domain.nx * c.domain.ny);
    constexpr double pressure_ns = 20.0;
    return {.arrays = {{"displacement", 8.0 * points / ranks}},
            .work = pressure_ns * points * static_cast<double>(c.time.frames),
            .useful_ranks = static_cast<int>(c.domain.nx)};
}

std::vector<Remark> SpringsEngine::limits(const Case& c) const {
    if (c.measure.depths_m == std::vector{0.0}) return {};
    return {{Severity::error, "measure.depths_mm", "springs have no depth"}};
}

void SpringsEngine::run(const Case& c, const Comm& team, engines::Observer& observer,
                        engines::Checkpoints* /*checkpoints*/) {
    const std::ptrdiff_t nx = c.domain.nx, ny = c.domain.ny;
    const std::ptrdiff_t start = nx * team.rank() / team.size();
    const std::ptrdiff_t count = nx * (team.rank() + 1) / team.size() - start;
    const Load& load = c.scene.load;
    const auto& springs = std::get<SpringsOptions>(c.solver);
    const double peak_m = load.peak_Pa * springs.length_m / springs.modulus_Pa;
    std::vector<double> u_z_m(static_cast<std::size_t>(count * ny));
    observer.begin({start, count});
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
        const double t_s = c.time.frame_s(n);
        const auto places = foci(load.modulation, t_s);
        const double scale = peak_m * amplitude(load, t_s) / static_cast<double>(places.size());
        for (std::ptrdiff_t i = 0; i < count; ++i)
            for (std::ptrdiff_t j = 0; j < ny; ++j) {
                double sum = 0.0;
                for (const Vec2& focus : places)
                    sum += pressure(load.footprint, c.domain.x_m(start + i) - focus.x,
                                    c.domain.y_m(j) - focus.y);
                u_z_m[static_cast<std::size_t>(i * ny + j)] = scale * sum;
            }
        observer.frame({.number = n, .u_z_m = View2<const double>(u_z_m.data(), count, ny)});
    }
}

} // namespace shearwake::springs
