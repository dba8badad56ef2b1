// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/pstd/scene/frames.hpp"

namespace shearwake::pstd {

/// The displacement of volume snapshots at the points of the domain and at z = 0, d, 2 d, ... down
/// to the absorbing layer. u_x and u_y are staggered by half a cell and are averaged over their
/// neighbours, with an error of second order in the spacing; at z = 0 they are extrapolated from
/// the two nodes below.
class DisplacementVolumes {
public:
    /// Allocates memory only if the case records volumes. Not collective.
    DisplacementVolumes(const Case& c, const CaseGrid& grid, const Slabs& slabs);

    /// Depths of the levels. Not collective.
    std::vector<double> levels_m() const;
    template <class Real>
    void add(const Stepper<Real>& stepper); // after every step; not collective
    /// Passes the planes of a snapshot to the observer. `u_z` contains at least `levels` planes,
    /// beginning at z = 0.
    void give(std::size_t snapshot, const Displacement& u_z, engines::Observer& observer,
              const Comm& team) const; // collective

    void save(StateWriter& state) const;    // collective
    void restore(const StateReader& state); // collective

private:
    using Plane = std::vector<double>;
    Plane x_mean(const Plane& plane, const Comm& team) const;
    Plane y_mean(const Plane& plane) const;

    const Case& c_;
    CaseGrid grid_;
    Slabs slabs_;
    engines::Slab slab_;
    /// U_x and u_y at the nodes below z = 0; empty without volumes.
    std::vector<Displacement> lateral_;
};

} // namespace shearwake::pstd
