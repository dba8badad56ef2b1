// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/layered/response/loss_tables.hpp"
#include "engines/layered/response/point_response.hpp"

namespace shearwake::layered {

/// Largest distance of two points of a grid with open edges for which its tables hold.
double open_reach_m(std::ptrdiff_t nx, std::ptrdiff_t ny, double spacing_m);

/// What the transfer tables of all media share on one grid with open edges. Not collective.
struct OpenGrid {
    std::ptrdiff_t nx, ny;
    double spacing_m;
    PointResponse point = {spacing_m, open_reach_m(nx, ny, spacing_m)};
    LossResponse loss = {spacing_m, open_reach_m(nx, ny, spacing_m)};
    PlaneSampling sampling = {nx / 2, ny / 2};

    OpenGrid(std::ptrdiff_t nx_points, std::ptrdiff_t ny_points, double spacing)
        : nx(nx_points), ny(ny_points), spacing_m(spacing) {}
    bool is_of(std::ptrdiff_t nx_points, std::ptrdiff_t ny_points, double spacing) const {
        return nx == nx_points && ny == ny_points && spacing_m == spacing;
    }
};

} // namespace shearwake::layered
