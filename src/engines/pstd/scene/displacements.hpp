// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"
#include "engines/engine.hpp"
#include "engines/pstd/scene/case_grid.hpp"
#include "engines/pstd/scheme/scheme.hpp"

#include <vector>

namespace shearwake::pstd {

/// Sums of dt times a velocity over some planes of z, on this rank's slab. After step n this is the
/// displacement at n dt to second order, because velocities belong to the middle of their steps.
class Displacement {
public:
    /// Planes first_z to first_z + planes - 1 of the storage. The scheme must outlive this object.
    Displacement(Field velocity, const Scheme& scheme, std::ptrdiff_t first_z,
                 std::ptrdiff_t planes);

    void add() { tally_->add(); } // after every step; not collective

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
    Slabs slabs_;
    std::ptrdiff_t planes_;
    std::unique_ptr<Tally> tally_;
};

/// Weights of the planes of u_z, beginning at z = 0, for u_z at a depth: linear interpolation
/// between two planes. At a skin with nothing above it u_z is discontinuous, and the Fourier
/// derivative along z oscillates: the planes are 0.93, 1.015, 0.994, ... of the true field for any
/// spacing. With SurfacePlane::rings the surface is therefore computed from five planes with
/// weights that reproduce the exact response of half-spaces for 200 to 1200 rad/m and 100 to 800 Hz
/// on grids of 0.25 and 0.5 mm.
enum class SurfacePlane { accurate, rings };
std::vector<double> depth_weights(double depth_m, double spacing_m, SurfacePlane surface);

/// Position of the frames of a case in its grid.
struct FramePlaces {
    std::ptrdiff_t first_x = 0, first_y = 0;  // of the domain
    std::ptrdiff_t first_z = 0, planes = 1;   // planes of u_z that are summed
    std::vector<std::vector<double>> weights; // weights of the planes from first_z, for each depth
};

/// The part of the domain that is in a rank's slab of the grid.
engines::Slab domain_slab(const Case& c, std::ptrdiff_t first_x, const Slabs& slabs);

/// u_z of the domain at the measured depths: weighted sums of planes of the displacement.
class Frames {
public:
    Frames(const Case& c, FramePlaces places, const Scheme& scheme);

    const engines::Slab& slab() const { return slab_; } // of the domain
    Displacement& displacement() { return u_z_; }
    const Displacement& displacement() const { return u_z_; }
    /// Passes frame `number` to the observer. Throws FieldDiverges on all ranks if a value is not
    /// finite or larger than the domain. Collective.
    void emit(std::ptrdiff_t number, engines::Observer& observer, const Comm& team);

private:
    const Case& c_;
    FramePlaces places_;
    Slabs slabs_;
    engines::Slab slab_;
    Displacement u_z_;
    std::vector<double> plane_m_;
};

/// The displacement of volume snapshots at the points of the domain and at z = 0, d, 2 d, ... down
/// to the absorbing layer. u_x and u_y are staggered by half a cell and are averaged over their
/// neighbours, with an error of second order in the spacing; at z = 0 they are extrapolated from
/// the two nodes below.
class DisplacementVolumes {
public:
    /// Allocates memory only if the case records volumes. Not collective.
    DisplacementVolumes(const Case& c, const CaseGrid& grid, const Scheme& scheme);

    /// Depths of the levels. Not collective.
    std::vector<double> levels_m() const;
    void add(); // after every step; not collective
    /// Passes the planes of a snapshot to the observer. `u_z` contains at least `levels` planes,
    /// beginning at z = 0.
    void emit(std::size_t snapshot, const Displacement& u_z, engines::Observer& observer,
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
