// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/rigid_bodies.hpp"
#include "fft/slab_transform.hpp"
#include "problem/case/case.hpp"

#include <optional>
#include <vector>

namespace shearwake::spectral {

/// The points of this rank's slab inside the rigid bodies of a case. The field that the engine
/// computes there is that of the material between the markers, which is at rest in the body only on
/// average; these functions replace it in planes [x_count][padded_ny]. Not collective.
class InsideBodies {
public:
    InsideBodies(const Case& c, const fft::SlabShare& share);

    /// Sets a component (0: x, 1: y, 2: z) of the displacement [m] at a depth to that of the
    /// bodies.
    void set_displacement(double depth_m, std::size_t component,
                          const std::vector<RigidMotion>& motions, double* plane) const;
    /// Sets strains and stresses to zero.
    void clear(double depth_m, double* plane) const;

private:
    /// Calls use(place in the plane, index of the body, offset from its centre).
    template <class Use>
    void each_point(double depth_m, const Use& use) const;

    std::vector<Body> bodies_;
    std::vector<std::optional<std::size_t>> motion_; // index of a body's motion
    Domain domain_;
    fft::SlabShare share_;
};

} // namespace shearwake::spectral
