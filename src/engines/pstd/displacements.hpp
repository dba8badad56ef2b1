#pragma once

#include "engines/checkpoint.hpp"
#include "engines/pstd/case_grid.hpp"
#include "engines/pstd/stepper.hpp"

#include <vector>

namespace shearwake::pstd {

/// Sums of dt times a velocity over some planes of z, on this rank's slab: after step n the
/// displacement at n dt to second order, since velocities stand in the middle of their steps.
class Displacement {
public:
    /// Planes first_z ... first_z + planes - 1 of the storage.
    Displacement(Field velocity, const Slabs& slabs, std::ptrdiff_t first_z, std::ptrdiff_t planes);

    template <class Real>
    void add(const Stepper<Real>& stepper); // after every step; not collective

    /// [x of the slab][y][plane], in metres.
    std::span<const double> values_m() const { return values_m_; }
    /// The weighted sum of planes from first_z on, [x of the slab][y].
    void sum(std::span<const double> weights, std::span<double> plane_m,
             std::ptrdiff_t from_plane = 0) const;
    /// Whether all values are finite, on all ranks. Collective.
    bool finite(const Comm& team) const;

    void save(StateWriter& state, const std::string& name) const; // collective
    void restore(StateReader& state, const std::string& name);    // collective

private:
    StateRows rows() const;
    Field velocity_;
    Slabs slabs_;
    std::ptrdiff_t first_z_, planes_;
    std::vector<double> values_m_;
};

/// Weights of the planes of u_z from z = 0 on that give u_z at a depth: linear between two planes.
/// At the skin with nothing above u_z jumps, and the Fourier derivative along z rings there: the
/// planes are 0.93, 1.015, 0.994, ... of the true field however fine the grid is. `rings`: the
/// surface itself is then taken from five planes, by weights that reproduce the exact response of
/// half-spaces to 200 ... 1200 rad/m and 100 ... 800 Hz on grids of 0.25 and 0.5 mm.
std::vector<double> depth_weights(double depth_m, double spacing_m, bool rings);

} // namespace shearwake::pstd
