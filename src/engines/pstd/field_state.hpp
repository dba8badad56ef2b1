#pragma once

#include "engines/pstd/pml.hpp"
#include "fft/aligned.hpp"

#include <algorithm>
#include <array>

namespace shearwake::pstd {

/// A field on a rank's slab: its totals, and its parts where those are kept (SplitRun): what they
/// leave of the total is the first of parts_of or, in a face of the layer, all others together.
template <class Real>
struct FieldState {
    AlignedVector<Real> total;
    std::array<AlignedVector<Real>, 2> part;
    SplitRuns runs;
    /// The layer's factors, [part][axis], by global index.
    std::array<std::array<AlignedVector<Real>, 3>, 3> factor;

    FieldState(Field field, const Slabs& slabs, const PmlOptions& pml, double reference_speed_m_s,
               const std::vector<Node>& split_nodes)
        : total(static_cast<std::size_t>(slabs.reals()), Real(0)),
          runs(slabs, pml, parts_of(field), split_nodes) {
        const Parts parts = parts_of(field);
        for (std::size_t p = 0; p + 1 < parts.count; ++p)
            part[p].assign(static_cast<std::size_t>(runs.size(p)), Real(0));
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

/// Where a part's factors stand for a row: that of x and y, and those of z.
template <class Real>
struct RowFactor {
    Real xy;
    const Real* z;
};
template <class Real>
RowFactor<Real> row_factor(const FieldState<Real>& f, std::size_t part, RowAt at) {
    const auto& of = f.factor[part];
    return {of[0][static_cast<std::size_t>(at.x)] * of[1][static_cast<std::size_t>(at.y)],
            of[2].data()};
}

/// A run whose total is one part that is kept, s, and a rest, each with its factor and its rate.
template <class Real, class Kept, class Rest>
void update_two(const SplitRun& run, Real* __restrict total, Real* __restrict s,
                RowFactor<Real> of_kept, const Kept& kept, RowFactor<Real> of_rest,
                const Rest& rest) {
#pragma GCC ivdep
    for (std::ptrdiff_t z = run.begin; z < run.end; ++z) {
        const Real qs = of_kept.xy * of_kept.z[z], q = of_rest.xy * of_rest.z[z];
        const Real of_others = total[z] - s[z], now = qs * (qs * s[z] + kept(z));
        s[z] = now;
        total[z] = q * (q * of_others + rest(z)) + now;
    }
}

/// Row update of a field with three parts, F_a <- Q_a (Q_a F_a + r_a), and of their sum where all
/// Q are 1. `first`, `second`, `third` give dt times the rates at z, in the order of parts_of.
template <class Real, class First, class Second, class Third>
void update_row(FieldState<Real>& f, const Parts& parts, std::ptrdiff_t nz, std::ptrdiff_t pitch,
                RowAt at, const First& first, const Second& second, const Third& third) {
    Real* __restrict total = f.total.data() + at.row * pitch;
    const RowFactor<Real> of[3] = {row_factor(f, 0, at), row_factor(f, 1, at),
                                   row_factor(f, 2, at)};
    std::ptrdiff_t done = 0;
    const auto unsplit_until = [&](std::ptrdiff_t end) {
#pragma GCC ivdep
        for (std::ptrdiff_t z = done; z < end; ++z)
            total[z] += first(z) + second(z) + third(z);
    };
    const auto all_parts = [&](const SplitRun& run, Real* __restrict b, Real* __restrict c) {
        const auto [a_xy, a_z] = of[0];
        const auto [b_xy, b_z] = of[1];
        const auto [c_xy, c_z] = of[2];
#pragma GCC ivdep
        for (std::ptrdiff_t z = run.begin; z < run.end; ++z) {
            const Real qa = a_xy * a_z[z], qb = b_xy * b_z[z], qc = c_xy * c_z[z];
            const Real of_a = total[z] - b[z] - c[z];
            const Real new_b = qb * (qb * b[z] + second(z)), new_c = qc * (qc * c[z] + third(z));
            b[z] = new_b;
            c[z] = new_c;
            total[z] = qa * (qa * of_a + first(z)) + new_b + new_c;
        }
    };
    const auto sum = [](const auto& a, const auto& b) {
        return [&](std::ptrdiff_t z) { return a(z) + b(z); };
    };
    for (const SplitRun& run : f.runs.row(at.row)) {
        unsplit_until(run.begin);
        Real* s = f.part[0].data() + (run.offset - run.begin);
        const auto face = static_cast<std::size_t>(std::max(run.face, 0));
        if (run.face < 0)
            all_parts(run, s, f.part[1].data() + (run.second - run.begin));
        else if (face == parts.axes[0])
            update_two(run, total, s, of[0], first, of[1], sum(second, third));
        else if (face == parts.axes[1])
            update_two(run, total, s, of[1], second, of[0], sum(first, third));
        else
            update_two(run, total, s, of[2], third, of[0], sum(first, second));
        done = run.end;
    }
    unsplit_until(nz);
}

/// The same for a field with two parts.
template <class Real, class First, class Second>
void update_row(FieldState<Real>& f, const Parts& parts, std::ptrdiff_t nz, std::ptrdiff_t pitch,
                RowAt at, const First& first, const Second& second) {
    Real* __restrict total = f.total.data() + at.row * pitch;
    const RowFactor<Real> of[2] = {row_factor(f, 0, at), row_factor(f, 1, at)};
    std::ptrdiff_t done = 0;
    const auto unsplit_until = [&](std::ptrdiff_t end) {
#pragma GCC ivdep
        for (std::ptrdiff_t z = done; z < end; ++z)
            total[z] += first(z) + second(z);
    };
    const auto one_factor = [&](const SplitRun& run) {
        const auto [xy, of_z] = of[0];
#pragma GCC ivdep
        for (std::ptrdiff_t z = run.begin; z < run.end; ++z) {
            const Real q = xy * of_z[z];
            total[z] = q * (q * total[z] + first(z) + second(z));
        }
    };
    for (const SplitRun& run : f.runs.row(at.row)) {
        unsplit_until(run.begin);
        Real* s = f.part[0].data() + (run.offset - run.begin);
        const auto face = static_cast<std::size_t>(std::max(run.face, 0));
        if (run.face < 0 || face == parts.axes[1])
            update_two(run, total, s, of[1], second, of[0], first);
        else if (face == parts.axes[0])
            update_two(run, total, s, of[0], first, of[1], second);
        else
            one_factor(run);
        done = run.end;
    }
    unsplit_until(nz);
}

} // namespace shearwake::pstd
