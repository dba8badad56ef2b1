// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/symmetric.hpp"

#include "engines/spectral/kernels/slices.hpp"
#include "simd/kernels.hpp"

#ifdef __SSE2__
#include <immintrin.h>
#endif

namespace shearwake::spectral {
namespace {

/// Conversion of floats to doubles. g++ 12 converts vectors of its extension in halves.
[[gnu::always_inline]] inline Vector load_floats(const float* from) {
#if defined(__AVX512F__)
    return _mm512_cvtps_pd(_mm256_loadu_ps(from));
#elif defined(__AVX__)
    return _mm256_cvtps_pd(_mm_loadu_ps(from));
#else
    using Floats = float __attribute__((vector_size(width * sizeof(float))));
    Floats v;
    __builtin_memcpy(&v, from, sizeof v);
    return __builtin_convertvector(v, Vector);
#endif
}

enum class Bits { all, rounded };

template <Bits bits>
[[gnu::always_inline]] inline Vector entry_of(const SymmetricArrays& matrix, std::ptrdiff_t at) {
    const Vector high = load_floats(matrix.high + at);
    return bits == Bits::rounded ? high : high + load_floats(matrix.low + at);
}

/// Adds the products of `rows` consecutive rows from row i on, and of their columns. An entry acts
/// in its row and, except on the diagonal, in its column. `at` is the first entry of row i.
/// Meanwhile the entries of the following rows are fetched: the processor does so too late by
/// itself, since it reads several short rows at a time.
template <Bits bits, std::ptrdiff_t rows>
[[gnu::always_inline]] inline void add_rows(const SymmetricArrays& matrix, std::ptrdiff_t i,
                                            std::ptrdiff_t at, std::ptrdiff_t s, const Block* x,
                                            Block* y) {
    Value mine[rows], sum[rows] = {};
    std::ptrdiff_t row[rows]; // first entry
    for (std::ptrdiff_t r = 0; r < rows; ++r) {
        mine[r] = get_parts(x + (i + r) * parts, s);
        row[r] = at;
        at += (i + r + 1) * lane_count;
    }
    for (std::ptrdiff_t j = 0; j < i; ++j) {
        const std::ptrdiff_t ahead = at + rows * j * lane_count;
        __builtin_prefetch(matrix.high + ahead);
        if constexpr (bits == Bits::all) __builtin_prefetch(matrix.low + ahead);
        const Value known = get_parts(x + j * parts, s);
        Value other = get_parts(y + j * parts, s);
        for (std::ptrdiff_t r = 0; r < rows; ++r) {
            const Vector a = entry_of<bits>(matrix, row[r] + j * lane_count);
            add(a, known, sum[r]);
            add(a, mine[r], other);
        }
        set_parts(y + j * parts, s, other);
    }
    for (std::ptrdiff_t r = 0; r < rows; ++r) {
        for (std::ptrdiff_t q = 0; q < r; ++q) {
            const Vector a = entry_of<bits>(matrix, row[r] + (i + q) * lane_count);
            add(a, mine[q], sum[r]);
            add(a, mine[r], sum[q]);
        }
        add(entry_of<bits>(matrix, row[r] + (i + r) * lane_count), mine[r], sum[r]);
    }
    for (std::ptrdiff_t r = 0; r < rows; ++r)
        set_parts(y + (i + r) * parts, s, sum[r]);
}

/// Two rows at a time, so that the unknowns of their columns are read and written once for both.
template <Bits bits>
void multiply(std::ptrdiff_t unknowns, const SymmetricArrays& matrix, const Block* x, Block* y) {
    const auto entry = [](std::ptrdiff_t i, std::ptrdiff_t s) {
        return i * (i + 1) / 2 * lane_count + s * width;
    };
    std::ptrdiff_t i = 0;
    for (; i + 1 < unknowns; i += 2)
        for (std::ptrdiff_t s = 0; s < slices; ++s)
            add_rows<bits, 2>(matrix, i, entry(i, s), s, x, y);
    if (i == unknowns) return;
    for (std::ptrdiff_t s = 0; s < slices; ++s)
        add_rows<bits, 1>(matrix, i, entry(i, s), s, x, y);
}

constexpr SymmetricKernels table = {multiply<Bits::all>, multiply<Bits::rounded>};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::SymmetricKernels&
shearwake::simd::compiled<shearwake::spectral::SymmetricKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
