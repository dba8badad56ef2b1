// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/pstd/scene/displacements.hpp"

namespace shearwake::pstd {

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
    Frames(const Case& c, FramePlaces places, const Slabs& slabs);

    const engines::Slab& slab() const { return slab_; } // of the domain
    Displacement& displacement() { return u_z_; }
    /// Passes frame `number` to the observer. Throws FieldDiverges on all ranks if a value is not
    /// finite or larger than the domain. Collective.
    void give(std::ptrdiff_t number, engines::Observer& observer, const Comm& team);

private:
    const Case& c_;
    FramePlaces places_;
    Slabs slabs_;
    engines::Slab slab_;
    Displacement u_z_;
    std::vector<double> plane_m_;
};

} // namespace shearwake::pstd
