// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/spectral/bodies/lump_bodies.hpp"
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
    double iterations = 0.0;    // per step
    CellExtent extent;          // that of all cells
    std::optional<BoxGrid> box; // on which iterations take place

    double planes() const { return points * components; }
    /// Points of the window of a line over x of nx points that is transformed; 0 for FFTs.
    double window(std::ptrdiff_t nx) const {
        const std::ptrdiff_t count = extent.x_end - extent.x_begin;
        return LineWindow::pays(nx, count) ? static_cast<double>(count) : 0.0;
    }
};

/// Number of iterations of a step whose products with the matrices of a box are rounded, and of all
/// products: one more for the response to the explicit stress, and one more after rounded ones.
inline double rounded_iterations(double iterations) {
    return std::max(0.0, iterations - full_iterations);
}
inline double box_products(double iterations) {
    return iterations + (rounded_iterations(iterations) > 0.0 ? 2.0 : 1.0);
}

/// Not collective.
VariationEstimate estimate_variation(const Case& c, const DepthMesh& mesh, double step_s,
                                     int ranks);

/// Resources of a case. The number of iterations is accurate within a factor of 1.5; the memory
/// is counted array by array. Not collective.
engines::Estimate estimate_spectral(const Case& c, const DepthMesh& mesh,
                                    std::ptrdiff_t steps_per_frame, int ranks);

} // namespace shearwake::spectral

namespace shearwake::spectral::kinds {

/// Quantities from which the work of a case is computed.
struct Measures {
    const VariationEstimate& variation;
    double nodes = 0.0, levels = 0.0, steps = 0.0;
    double sponge_values = 0.0, sponge_every = 0.0; // 0: no sponge
    double perceived = 0.0;                         // planes of receptor stress per frame
    double reactions = 0.0;                         // solves per step for forces of rigid bodies
    LumpSizes lumps;                                // rigid ones
    double near_pairs = 0.0;                        // lump_stress_pairs()
    double from_memory = 0.0; // share of the first solves of steps that is limited by memory
    double iterated_from_memory =
        0.0; // share of the solves of iterations that is limited by memory
};

/// Adds the work of the case to the estimate. Not collective.
void add_work(const Case& c, const Measures& measures, engines::Estimate& e);

/// One case for each kind of work, in which that kind dominates. Not collective.
std::vector<engines::Calibration> calibrations();

} // namespace shearwake::spectral::kinds
