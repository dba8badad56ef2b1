#pragma once

#include "engines/engine.hpp"

namespace shearwake::pstd {

/// What steps of the scheme take on a grid.
struct Work {
    double points = 0.0, steps = 0.0;
    bool lossy = false, single = false;
};

/// Seconds on one rank, as `bench pstd` measures them on a core of 2020; all-to-alls; not the
/// memory. Not collective.
inline Estimate estimate_steps(const Work& work) {
    const double of_point_s = work.lossy ? 58e-9 : 40e-9; // single: 0.63 of it
    Estimate e;
    e.seconds = work.points * work.steps * of_point_s * (work.single ? 0.63 : 1.0);
    // There and back, three stresses and then three velocities, where lossy with accelerations.
    e.all_to_alls = 4.0 * work.steps;
    e.all_to_all_B = (work.lossy ? 4.5 : 3.0) * work.points * (work.single ? 4.0 : 8.0);
    return e;
}

} // namespace shearwake::pstd
