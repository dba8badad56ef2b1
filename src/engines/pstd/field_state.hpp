#pragma once

#include "engines/pstd/pml.hpp"
#include "fft/aligned.hpp"

#include <array>

namespace shearwake::pstd {

/// A field on a rank's slab: its totals, and its parts where those are kept (all but the first of
/// parts_of: that one is what the others leave of the total).
template <class Real>
struct FieldState {
    AlignedVector<Real> total;
    std::array<AlignedVector<Real>, 2> part;
    SplitRuns runs;
    /// The layer's factors, [part][axis], by global index.
    std::array<std::array<AlignedVector<Real>, 3>, 3> factor;

    FieldState(Field field, const Slabs& slabs, const PmlOptions& pml, double reference_speed_m_s,
               const std::vector<Node>& split_nodes)
        : total(static_cast<std::size_t>(slabs.reals()), Real(0)), runs(slabs, pml, split_nodes) {
        const Parts parts = parts_of(field);
        for (std::size_t p = 0; p + 1 < parts.count; ++p)
            part[p].assign(static_cast<std::size_t>(runs.size()), Real(0));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const PmlProfile profile =
                pml_profile(slabs.grid, pml, axis, is_staggered(field, axis), reference_speed_m_s);
            for (std::size_t p = 0; p < parts.count; ++p) {
                const auto& of = parts.axes[p] == axis ? profile.main : profile.other;
                factor[p][axis].assign(of.begin(), of.end());
            }
        }
    }
};

/// Where a row of z stands: its number on the rank, its global x and y.
struct RowAt {
    std::ptrdiff_t row, x, y;
};

/// Row update of a field with three parts, F_a <- Q_a (Q_a F_a + r_a), and of their sum where all
/// Q are 1. `first`, `second`, `third` give dt times the rates at z, in the order of parts_of.
template <class Real, class First, class Second, class Third>
void update_row(FieldState<Real>& f, std::ptrdiff_t nz, std::ptrdiff_t pitch, RowAt at,
                const First& first, const Second& second, const Third& third) {
    Real* __restrict total = f.total.data() + at.row * pitch;
    const auto x = static_cast<std::size_t>(at.x), y = static_cast<std::size_t>(at.y);
    const Real xy[3] = {f.factor[0][0][x] * f.factor[0][1][y],
                        f.factor[1][0][x] * f.factor[1][1][y],
                        f.factor[2][0][x] * f.factor[2][1][y]};
    std::ptrdiff_t done = 0;
    const auto unsplit_until = [&](std::ptrdiff_t end) {
#pragma GCC ivdep
        for (std::ptrdiff_t z = done; z < end; ++z)
            total[z] += first(z) + second(z) + third(z);
    };
    for (const SplitRun& run : f.runs.row(at.row)) {
        unsplit_until(run.begin);
        Real* __restrict b = f.part[0].data() + (run.offset - run.begin);
        Real* __restrict c = f.part[1].data() + (run.offset - run.begin);
        const Real *za = f.factor[0][2].data(), *zb = f.factor[1][2].data(),
                   *zc = f.factor[2][2].data();
#pragma GCC ivdep
        for (std::ptrdiff_t z = run.begin; z < run.end; ++z) {
            const Real qa = xy[0] * za[z], qb = xy[1] * zb[z], qc = xy[2] * zc[z];
            const Real of_a = total[z] - b[z] - c[z];
            const Real new_b = qb * (qb * b[z] + second(z)), new_c = qc * (qc * c[z] + third(z));
            b[z] = new_b;
            c[z] = new_c;
            total[z] = qa * (qa * of_a + first(z)) + new_b + new_c;
        }
        done = run.end;
    }
    unsplit_until(nz);
}

/// The same for a field with two parts.
template <class Real, class First, class Second>
void update_row(FieldState<Real>& f, std::ptrdiff_t nz, std::ptrdiff_t pitch, RowAt at,
                const First& first, const Second& second) {
    Real* __restrict total = f.total.data() + at.row * pitch;
    const auto x = static_cast<std::size_t>(at.x), y = static_cast<std::size_t>(at.y);
    const Real xy[2] = {f.factor[0][0][x] * f.factor[0][1][y],
                        f.factor[1][0][x] * f.factor[1][1][y]};
    std::ptrdiff_t done = 0;
    const auto unsplit_until = [&](std::ptrdiff_t end) {
#pragma GCC ivdep
        for (std::ptrdiff_t z = done; z < end; ++z)
            total[z] += first(z) + second(z);
    };
    for (const SplitRun& run : f.runs.row(at.row)) {
        unsplit_until(run.begin);
        Real* __restrict b = f.part[0].data() + (run.offset - run.begin);
        const Real *za = f.factor[0][2].data(), *zb = f.factor[1][2].data();
#pragma GCC ivdep
        for (std::ptrdiff_t z = run.begin; z < run.end; ++z) {
            const Real qa = xy[0] * za[z], qb = xy[1] * zb[z];
            const Real of_a = total[z] - b[z], new_b = qb * (qb * b[z] + second(z));
            b[z] = new_b;
            total[z] = qa * (qa * of_a + first(z)) + new_b;
        }
        done = run.end;
    }
    unsplit_until(nz);
}

} // namespace shearwake::pstd
