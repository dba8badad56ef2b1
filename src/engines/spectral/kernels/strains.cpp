// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/strains.hpp"

#include "simd/kernels.hpp"
#include "simd/vector.hpp"

// Plain loops that the compiler vectorises, except for sums, whose order must not change.

namespace shearwake::spectral {
namespace {

void stress(std::ptrdiff_t n, const double* __restrict lambda, const double* __restrict mu,
            const double* __restrict viscosity, double rate, const double* __restrict e,
            const double* __restrict b, double* __restrict s) {
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        const double dilation = lambda[i] * (e[i] + e[n + i] + e[2 * n + i]);
        const double lossy = viscosity[i] * rate;
        for (std::ptrdiff_t c = 0; c < 6; ++c) {
            const double strain = e[c * n + i];
            const double both = mu[i] * strain + lossy * (strain - b[c * n + i]);
            s[c * n + i] = c < 3 ? dilation + 2.0 * both : both;
        }
    }
}

void elastic(std::ptrdiff_t n, const double* __restrict lambda, const double* __restrict mu,
             const double* __restrict e, double* __restrict s) {
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        const double dilation = lambda[i] * (e[i] + e[n + i] + e[2 * n + i]);
        for (std::ptrdiff_t c = 0; c < 6; ++c) {
            const double own = mu[i] * e[c * n + i];
            s[c * n + i] = c < 3 ? dilation + 2.0 * own : own;
        }
    }
}

/// Uses two blocks of partial sums at any vector width, because the order affects the result.
double product(std::ptrdiff_t count, const double* a, const double* b) {
    using namespace simd;
    constexpr std::ptrdiff_t sums = 2 * lane_count / width;
    Vector sum[sums] = {};
    std::ptrdiff_t i = 0;
    for (; i + 2 * lane_count <= count; i += 2 * lane_count)
        for (std::ptrdiff_t v = 0; v < sums; ++v)
            sum[v] += load(a + i + v * width) * load(b + i + v * width);
    Block first, second;
    for (std::ptrdiff_t v = 0; v < sums / 2; ++v) {
        store_aligned(sum[v], first.lane + v * width);
        store_aligned(sum[v + sums / 2], second.lane + v * width);
    }
    double rest = 0.0;
    for (; i < count; ++i)
        rest += a[i] * b[i];
    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
        first[lane] += second[lane];
    return sum_of(first) + rest;
}

void step(std::ptrdiff_t count, double alpha, const double* __restrict a,
          const double* __restrict b, double* __restrict x, double* __restrict y) {
    for (std::ptrdiff_t i = 0; i < count; ++i) {
        x[i] += alpha * a[i];
        y[i] -= alpha * b[i];
    }
}

void turn(std::ptrdiff_t count, double beta, const double* __restrict a, double* __restrict x) {
    for (std::ptrdiff_t i = 0; i < count; ++i)
        x[i] = a[i] + beta * x[i];
}

void subtract_from(std::ptrdiff_t count, const double* __restrict a, double* __restrict x) {
    for (std::ptrdiff_t i = 0; i < count; ++i)
        x[i] = a[i] - x[i];
}

void advance(std::ptrdiff_t count, double scale, const double* __restrict now,
             const double* __restrict change, double* __restrict before) {
    for (std::ptrdiff_t i = 0; i < count; ++i)
        before[i] = 2.0 * now[i] - before[i] + scale * change[i];
}

constexpr StrainKernels table = {stress, elastic, product, step, turn, subtract_from, advance};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::StrainKernels&
shearwake::simd::compiled<shearwake::spectral::StrainKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
