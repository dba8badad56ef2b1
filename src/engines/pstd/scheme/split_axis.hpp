// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/grid.hpp"
#include "fft/staggered_derivative.hpp"
#include "parallel/comm.hpp"

#include <span>
#include <vector>

namespace shearwake::pstd {

/// The number of parts in which SplitAxis exchanges a field of which a rank has `bytes`: parts that
/// stay in the cache of a core between the exchange, the transforms and the way back, unless their
/// messages would be so short that latency counts.
std::ptrdiff_t parts_of_exchange(double bytes, int ranks);

/// Derivatives along x, the axis that is split among the ranks: slabs of x become slabs of y, whose
/// x-lines are whole, and back. Other ranks' lines are exchanged part by part; what stays on a rank
/// is read and written where it is.
template <class Real>
class SplitAxis {
public:
    struct Task {
        const Real* field; // slab of this rank
        fft::HalfCell shift;
    };
    /// Supports at most `most_fields` tasks per call. Collective.
    SplitAxis(const Slabs& slabs, const Comm& team, std::size_t most_fields);

    /// Computes the derivatives of all tasks. Collective.
    void differentiate(std::span<const Task> tasks);
    /// Row (x, y) of the derivative of task number `task` of the last call, where x is relative to
    /// the slab. Not collective.
    const Real* row(std::size_t task, std::ptrdiff_t x, std::ptrdiff_t y) const {
        const Place& p = places_[static_cast<std::size_t>(y)];
        return p.first + static_cast<std::ptrdiff_t>(task) * p.task_stride + x * p.x_stride;
    }

private:
    struct Place {
        const Real* first;
        std::ptrdiff_t x_stride, task_stride;
    };
    /// Rows of y, counted from a rank's first.
    struct Rows {
        std::ptrdiff_t begin, end;
        std::ptrdiff_t count() const { return end - begin; }
    };
    /// One of the parts in which a field is exchanged.
    struct Part {
        std::vector<Rows> rows;                     // of every rank
        std::vector<std::ptrdiff_t> sent, received; // values to and from every rank
        std::ptrdiff_t offset;                      // among what comes back of a field
    };
    Part part(std::ptrdiff_t number, std::ptrdiff_t parts) const;
    void set_places();
    void pack(const Task& task, const Part& part);
    void along_x(std::size_t number, const Task& task, const Part& part);

    Slabs slabs_;
    Comm team_;
    fft::StaggeredDerivative<Real> derivative_;
    std::vector<Part> parts_;
    fft::AlignedVector<Real> mine_; // derivatives of what is in both of this rank's slabs
    fft::AlignedVector<Real>
        others_; // [field][part][other rank][x here][y there]: those made there
    fft::AlignedVector<Real> leaving_; // [other rank][x here][y there] of a part
    fft::AlignedVector<Real> lines_;   // [other rank][x there][y here] of a part
    std::vector<Place> places_;        // by y
};

} // namespace shearwake::pstd
