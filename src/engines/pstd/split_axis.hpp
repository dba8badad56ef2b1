#pragma once

#include "engines/pstd/grid.hpp"
#include "fft/staggered_derivative.hpp"
#include "parallel/comm.hpp"

#include <span>

namespace shearwake::pstd {

/// Derivatives along x, the axis that is split among the ranks: slabs of x become slabs of y, whose
/// x-lines are whole, and back. What stays on a rank is read and written where it is.
template <class Real>
class SplitAxis {
public:
    struct Task {
        const Real* field; // this rank's slab
        HalfCell shift;
    };
    /// Of at most `most_fields` at once. Collective.
    SplitAxis(const Slabs& slabs, const Comm& team, std::size_t most_fields);

    /// Collective.
    void differentiate(std::span<const Task> tasks);
    /// The derivative of the latest call's task number `task`: its row (x, y), x counted from the
    /// slab's first. Not collective.
    const Real* row(std::size_t task, std::ptrdiff_t x, std::ptrdiff_t y) const {
        const Place& p = places_[static_cast<std::size_t>(y)];
        return p.first + (static_cast<std::ptrdiff_t>(task) * slabs_.x_count() + x) * p.x_stride;
    }

private:
    struct Place {
        const Real* first;
        std::ptrdiff_t x_stride;
    };
    void pack(std::span<const Task> tasks);
    void along_x(std::size_t number, const Task& task);
    std::ptrdiff_t sent_to(int rank) const;       // values of one field
    std::ptrdiff_t received_from(int rank) const; // values of one field
    void set_places();
    enum class Side { x, y };
    std::vector<int> counts(Side side) const;

    Slabs slabs_;
    Comm team_;
    StaggeredDerivative<Real> derivative_;
    AlignedVector<Real> mine_;        // derivatives of what is in both of this rank's slabs
    AlignedVector<Real> travelling_;  // [other rank][field][x here][y there]: fields, then theirs
    AlignedVector<Real> whole_lines_; // [other rank][field][x there][y here]: the same
    std::ptrdiff_t number_of_fields_ = 0; // of the latest call
    std::vector<Place> places_;           // by y
};

} // namespace shearwake::pstd
