// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"
#include "engines/pstd/scene/case_grid.hpp"
#include "engines/pstd/scheme/stepper.hpp"

#include <vector>

namespace shearwake::pstd {

/// Sums of dt times a velocity over some planes of z, on this rank's slab. After step n this is the
/// displacement at n dt to second order, because velocities belong to the middle of their steps.
class Displacement {
public:
    /// Planes first_z to first_z + planes - 1 of the storage.
    Displacement(Field velocity, const Slabs& slabs, std::ptrdiff_t first_z, std::ptrdiff_t planes);

    template <class Real>
    void add(const Stepper<Real>& stepper); // after every step; not collective

    /// [x of the slab][y][plane], in metres.
    std::span<const double> values_m() const { return values_m_; }
    /// The weighted sum of planes beginning with first_z + from_plane, [x of the slab][y], in
    /// metres. Not collective.
    void sum(std::span<const double> weights, std::span<double> plane_m,
             std::ptrdiff_t from_plane = 0) const;
    /// The largest magnitude on all ranks, in metres; infinity if a value is not finite.
    /// Collective.
    double largest_m(const Comm& team) const;

    void save(StateWriter& state, const std::string& name) const;    // collective
    void restore(const StateReader& state, const std::string& name); // collective

private:
    DistributedRows rows() const;
    Field velocity_;
    Slabs slabs_;
    std::ptrdiff_t first_z_, planes_;
    std::vector<double> values_m_;
};

/// Weights of the planes of u_z, beginning at z = 0, for u_z at a depth: linear interpolation
/// between two planes. At a skin with nothing above it u_z is discontinuous, and the Fourier
/// derivative along z oscillates: the planes are 0.93, 1.015, 0.994, ... of the true field for any
/// spacing. With SurfacePlane::rings the surface is therefore computed from five planes with
/// weights that reproduce the exact response of half-spaces for 200 to 1200 rad/m and 100 to 800 Hz
/// on grids of 0.25 and 0.5 mm.
enum class SurfacePlane { kept, rings };
std::vector<double> depth_weights(double depth_m, double spacing_m, SurfacePlane surface);

} // namespace shearwake::pstd
