// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fft/run_transform.hpp"
#include "parallel/comm.hpp"

#include <span>
#include <utility>
#include <vector>

namespace shearwake::spectral {

/// Range of the grid points of a plane, [begin, end), that contains all cells of some planes.
struct CellExtent {
    std::ptrdiff_t x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// The cells of planes at points over depth on this rank's rows, which belong to someone else.
/// Their values are stored as [point][component][cell].
struct PlaneCells {
    struct Point {
        std::vector<fft::RowRun> runs;
        std::size_t first = 0, cells = 0; // number of cells of earlier points, and of this one
    };
    std::span<const Point> points;
    std::size_t components = 0;
    std::ptrdiff_t x_start = 0; // global index of the first row of x of this rank

    /// Range of the indices of a point's values. Not collective.
    std::pair<std::size_t, std::size_t> range(std::size_t point) const {
        return {points[point].first * components,
                (points[point].first + points[point].cells) * components};
    }
    /// Extent of the cells of all ranks. Collective.
    CellExtent extent(const Comm& team) const;
};

} // namespace shearwake::spectral
