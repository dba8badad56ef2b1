// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/pml.hpp"
#include "fft/aligned.hpp"

#include <array>

namespace shearwake::pstd {

/// Where the parts of a field are kept, and their factors.
template <class Real>
struct FieldLayout {
    SplitRuns runs;
    /// The layer's factors, [part][axis], by global index.
    std::array<std::array<fft::AlignedVector<Real>, 3>, 3> factor;

    FieldLayout(Field field, const Slabs& slabs, const PmlOptions& pml, double reference_speed_m_s,
                const std::vector<Node>& split_nodes)
        : runs(slabs, pml, parts_of(field), split_nodes) {
        const Parts parts = parts_of(field);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const PmlProfile profile = pml_profile(
                slabs.grid, pml, axis,
                is_staggered(field, axis) ? PmlPlaces::half_a_cell_on : PmlPlaces::nodes,
                reference_speed_m_s);
            for (std::size_t p = 0; p < parts.count; ++p) {
                const auto& of = parts.axes[p] == axis ? profile.main : profile.other;
                factor[p][axis].assign(of.begin(), of.end());
            }
        }
    }
};

/// A field on a rank's slab: its totals, and its parts where those are kept (SplitRun): what they
/// leave of the total is the first of parts_of or, in a face of the layer, all others together.
template <class Real>
struct FieldState : FieldLayout<Real> {
    fft::AlignedVector<Real> total;
    std::array<fft::AlignedVector<Real>, 2> part;

    FieldState(Field field, const Slabs& slabs, const PmlOptions& pml, double reference_speed_m_s,
               const std::vector<Node>& split_nodes)
        : FieldLayout<Real>(field, slabs, pml, reference_speed_m_s, split_nodes),
          total(static_cast<std::size_t>(slabs.reals()), Real(0)) {
        for (std::size_t p = 0; p + 1 < parts_of(field).count; ++p)
            part[p].assign(static_cast<std::size_t>(this->runs.size(p)), Real(0));
    }
};

/// Where a row of z stands: its number on the rank, its global x and y.
struct RowAt {
    std::ptrdiff_t row, x, y;
};

/// A row as the kernels take it.
template <class Real>
FieldRow<Real> row_of(FieldState<Real>& f, const Parts& parts, const Slabs& slabs, RowAt at) {
    FieldRow<Real> row{.nz = slabs.nz(),
                       .total = f.total.data() + at.row * slabs.pitch,
                       .part = {f.part[0].data(), f.part[1].data()},
                       .factor = {},
                       .axes = {},
                       .first_run = f.runs.row(at.row).begin(),
                       .last_run = f.runs.row(at.row).end()};
    for (std::size_t p = 0; p < parts.count; ++p) {
        const auto& of = f.factor[p];
        row.factor[p] = {of[0][static_cast<std::size_t>(at.x)] *
                             of[1][static_cast<std::size_t>(at.y)],
                         of[2].data()};
        row.axes[p] = static_cast<int>(parts.axes[p]);
    }
    return row;
}

} // namespace shearwake::pstd
