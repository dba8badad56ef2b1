// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/kernels/update.hpp"

#include "simd/kernels.hpp"

// Before a loop whose iterations do not depend on each other, though they may share arrays.
#ifdef __clang__
#define SHEARWAKE_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define SHEARWAKE_INDEPENDENT _Pragma("GCC ivdep")
#endif

namespace shearwake::pstd {
namespace {

/// A run whose total is one stored part, s, and a rest, each with its factor and its rate.
template <class Real, class Part, class Rest>
[[gnu::always_inline]] inline void
update_two(const SplitRun& run, Real* __restrict total, Real* __restrict s, RowFactor<Real> of_part,
           const Part& part, RowFactor<Real> of_rest, const Rest& rest) {
    SHEARWAKE_INDEPENDENT
    for (std::ptrdiff_t z = run.begin; z < run.end; ++z) {
        const Real qs = of_part.xy * of_part.z[z], q = of_rest.xy * of_rest.z[z];
        const Real of_others = total[z] - s[z], now = qs * (qs * s[z] + part(z));
        s[z] = now;
        total[z] = q * (q * of_others + rest(z)) + now;
    }
}

/// `first`, `second`, `third` give dt times the rates at z.
template <class Real, class First, class Second, class Third>
[[gnu::always_inline]] inline void update_row(const FieldRow<Real>& row, const First& first,
                                              const Second& second, const Third& third) {
    Real* __restrict total = row.total;
    const RowFactor<Real>* of = row.factor;
    std::ptrdiff_t done = 0;
    const auto unsplit_until = [&](std::ptrdiff_t end) {
        SHEARWAKE_INDEPENDENT
        for (std::ptrdiff_t z = done; z < end; ++z)
            total[z] += first(z) + second(z) + third(z);
    };
    const auto update_parts = [&](const SplitRun& run, Real* __restrict b, Real* __restrict c) {
        const auto [a_xy, a_z] = of[0];
        const auto [b_xy, b_z] = of[1];
        const auto [c_xy, c_z] = of[2];
        SHEARWAKE_INDEPENDENT
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
    for (const SplitRun* run = row.first_run; run != row.last_run; ++run) {
        unsplit_until(run->begin);
        Real* s = row.part[0] + (run->offset - run->begin);
        if (run->face < 0)
            update_parts(*run, s, row.part[1] + (run->second - run->begin));
        else if (run->face == row.axes[0])
            update_two(*run, total, s, of[0], first, of[1], sum(second, third));
        else if (run->face == row.axes[1])
            update_two(*run, total, s, of[1], second, of[0], sum(first, third));
        else
            update_two(*run, total, s, of[2], third, of[0], sum(first, second));
        done = run->end;
    }
    unsplit_until(row.nz);
}

/// The same for a field with two parts.
template <class Real, class First, class Second>
[[gnu::always_inline]] inline void update_row(const FieldRow<Real>& row, const First& first,
                                              const Second& second) {
    Real* __restrict total = row.total;
    const RowFactor<Real>* of = row.factor;
    std::ptrdiff_t done = 0;
    const auto unsplit_until = [&](std::ptrdiff_t end) {
        SHEARWAKE_INDEPENDENT
        for (std::ptrdiff_t z = done; z < end; ++z)
            total[z] += first(z) + second(z);
    };
    const auto update_by_factor = [&](const SplitRun& run) {
        const auto [xy, of_z] = of[0];
        SHEARWAKE_INDEPENDENT
        for (std::ptrdiff_t z = run.begin; z < run.end; ++z) {
            const Real q = xy * of_z[z];
            total[z] = q * (q * total[z] + first(z) + second(z));
        }
    };
    for (const SplitRun* run = row.first_run; run != row.last_run; ++run) {
        unsplit_until(run->begin);
        // Nothing is stored if all runs have one factor.
        Real* s = row.part[0] ? row.part[0] + (run->offset - run->begin) : nullptr;
        if (run->face < 0 || run->face == row.axes[1])
            update_two(*run, total, s, of[1], second, of[0], first);
        else if (run->face == row.axes[0])
            update_two(*run, total, s, of[0], first, of[1], second);
        else
            update_by_factor(*run);
        done = run->end;
    }
    unsplit_until(row.nz);
}

template <class Real>
void velocity(const FieldRow<Real>& row, const Real* c, const Real* const g[3],
              Real* acceleration) {
    const Real *first = g[0], *second = g[1], *third = g[2];
    update_row(
        row, [=](std::ptrdiff_t z) { return c[z] * first[z]; },
        [=](std::ptrdiff_t z) { return c[z] * second[z]; },
        [=](std::ptrdiff_t z) { return c[z] * third[z]; });
    if (!acceleration) return;
    SHEARWAKE_INDEPENDENT
    for (std::ptrdiff_t z = 0; z < row.nz; ++z)
        acceleration[z] = c[z] * (first[z] + second[z] + third[z]);
}

template <class Real>
[[gnu::always_inline]] inline auto elastic(const Rate<Real>& rate) {
    return [k = rate.k, e = rate.e](std::ptrdiff_t z) { return k[z] * e[z]; };
}

template <class Real>
[[gnu::always_inline]] inline auto viscous(const Rate<Real>& rate) {
    return [k = rate.k, e = rate.e, v = rate.v, de = rate.de](std::ptrdiff_t z) {
        return k[z] * e[z] + v[z] * de[z];
    };
}

template <class Real>
void normal(const FieldRow<Real>& row, const Rate<Real> rates[3]) {
    update_row(row, elastic(rates[0]), elastic(rates[1]), elastic(rates[2]));
}

template <class Real>
void normal_lossy(const FieldRow<Real>& row, const Rate<Real> rates[3]) {
    update_row(row, viscous(rates[0]), viscous(rates[1]), viscous(rates[2]));
}

template <class Real>
void shear(const FieldRow<Real>& row, const Rate<Real> rates[2]) {
    update_row(row, elastic(rates[0]), elastic(rates[1]));
}

template <class Real>
void shear_lossy(const FieldRow<Real>& row, const Rate<Real> rates[2]) {
    update_row(row, viscous(rates[0]), viscous(rates[1]));
}

template <class Real>
constexpr UpdateKernels<Real> table = {velocity<Real>, normal<Real>, normal_lossy<Real>,
                                       shear<Real>, shear_lossy<Real>};

} // namespace
} // namespace shearwake::pstd

namespace shearwake::simd {

template <>
const pstd::UpdateKernels<double>& compiled<pstd::UpdateKernels<double>, this_set>() {
    return pstd::table<double>;
}

template <>
const pstd::UpdateKernels<float>& compiled<pstd::UpdateKernels<float>, this_set>() {
    return pstd::table<float>;
}

} // namespace shearwake::simd
