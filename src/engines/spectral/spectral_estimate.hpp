// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/march.hpp"
#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/spectral/lateral/box_response.hpp"
#include "engines/spectral/lateral/strain_solver.hpp"

#include <algorithm>
#include <optional>

namespace shearwake::spectral {

/// Size of the laterally varying part of a case, estimated from the bounds of bodies and a few
/// samples of the map, without evaluating the cells.
struct VariationEstimate {
    double points = 0.0; // strain points; each has `components` planes
    double components = 0.0;
    double cells = 0.0;         // cells with data, sum over all points
    double fullest_cells = 0.0; // on the rank with most cells
    bool iterates = false;      // whether every step takes iterations
    CellExtent extent;          // that of all cells
    std::optional<BoxGrid> box; // on which iterations take place

    double planes() const { return points * components; }
    /// Points of the window of a line over x of nx points that is transformed; 0 for FFTs.
    double window(std::ptrdiff_t nx) const {
        const std::ptrdiff_t count = extent.x_end - extent.x_begin;
        return LineWindow::pays(nx, count) ? static_cast<double>(count) : 0.0;
    }
};

/// Not collective.
VariationEstimate estimate_variation(const Case& c, const DepthMesh& mesh, double step_s,
                                     int ranks);

/// Resources of a case. The memory is counted array by array. Not collective.
engines::Estimate estimate_spectral(const Case& c, const DepthMesh& mesh,
                                    std::ptrdiff_t steps_per_frame, int ranks);

/// The work of the steps of a case. Not collective.
engines::MarchWork march_work(const Case& c, const DepthMesh& mesh, std::ptrdiff_t steps_per_frame);

} // namespace shearwake::spectral
