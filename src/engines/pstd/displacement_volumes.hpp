#pragma once

#include "engines/engine.hpp"
#include "engines/pstd/frames.hpp"

namespace shearwake::pstd {

/// The displacement of volume snapshots at the domain's points and at z = 0, d, 2 d, ... as deep as
/// nothing absorbs. u_x and u_y stand half a cell off, and are the means of their neighbours: of
/// second order in the spacing; at z = 0 they are extrapolated from the two nodes below.
class DisplacementVolumes {
public:
    /// Holds no memory where the case keeps no volume.
    DisplacementVolumes(const Case& c, const CaseGrid& grid, const Slabs& slabs);

    std::vector<double> levels_m() const;
    template <class Real>
    void add(const Stepper<Real>& stepper); // after every step; not collective
    /// u_z comes from `u_z`, whose planes begin at z = 0 and are at least `levels`.
    void give(std::size_t snapshot, const Displacement& u_z, Observer& observer,
              const Comm& team) const; // collective

    void save(StateWriter& state) const; // collective
    void restore(StateReader& state);    // collective

private:
    using Plane = std::vector<double>;
    Plane x_mean(const Plane& plane, const Comm& team) const;
    Plane y_mean(const Plane& plane) const;

    const Case& c_;
    CaseGrid grid_;
    Slabs slabs_;
    Slab slab_;
    std::vector<Displacement> lateral_; // u_x and u_y at the nodes below z = 0; or nothing
};

} // namespace shearwake::pstd
