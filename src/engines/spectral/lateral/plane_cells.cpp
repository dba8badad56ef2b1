// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/plane_cells.hpp"

#include <algorithm>
#include <limits>

namespace shearwake::spectral {

CellExtent PlaneCells::extent(const Comm& team) const {
    constexpr double none = std::numeric_limits<double>::lowest();
    double most[4] = {none, none, none, none}; // -x, x, -y, y
    const auto widen = [](double& at, std::ptrdiff_t value) {
        at = std::max(at, static_cast<double>(value));
    };
    for (const Point& point : points)
        for (const fft::RowRun& run : point.runs) {
            const std::ptrdiff_t x = x_start + run.row;
            widen(most[0], -x);
            widen(most[1], x + 1);
            widen(most[2], -run.begin);
            widen(most[3], run.end);
        }
    team.max(std::span<double>(most));
    if (most[0] == none) return {};
    const auto index = [](double value) { return static_cast<std::ptrdiff_t>(value); };
    return {index(-most[0]), index(most[1]), index(-most[2]), index(most[3])};
}

} // namespace shearwake::spectral
