#pragma once

#include "engines/engine.hpp"
#include "engines/pstd/displacements.hpp"

namespace shearwake::pstd {

/// Where the frames of a case stand in its grid.
struct FramePlaces {
    std::ptrdiff_t first_x = 0, first_y = 0;  // of the domain
    std::ptrdiff_t first_z = 0, planes = 1;   // of u_z, that are summed up
    std::vector<std::vector<double>> weights; // of the planes from first_z on, for each depth
};

/// The part of a rank's slab of the grid that belongs to the domain.
Slab domain_slab(const Case& c, std::ptrdiff_t first_x, const Slabs& slabs);

/// u_z of the domain at the measured depths: weighted sums of planes of the displacement.
class Frames {
public:
    Frames(const Case& c, FramePlaces places, const Slabs& slabs);

    const Slab& slab() const { return slab_; } // of the domain
    Displacement& displacement() { return u_z_; }
    /// Throws FieldDiverges on all ranks when it is not finite. Collective.
    void give(std::ptrdiff_t number, Observer& observer, const Comm& team);

private:
    const Case& c_;
    FramePlaces places_;
    Slabs slabs_;
    Slab slab_;
    Displacement u_z_;
    std::vector<double> plane_m_;
};

} // namespace shearwake::pstd
