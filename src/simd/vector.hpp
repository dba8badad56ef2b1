// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#ifdef __AVX512F__
#include <immintrin.h>
#endif

// Vectors for kernels (simd/kernels.hpp) with the number of doubles that one instruction processes.
// These are the vector extensions of g++ and clang: arithmetic, comparison and ?: work lane by
// lane. The unnamed namespace keeps the code of different instruction sets apart.

namespace shearwake::simd {
namespace { // NOLINT(cert-dcl59-cpp): see above

#if defined(__AVX512F__)
inline constexpr std::ptrdiff_t width = 8;
#elif defined(__AVX__)
inline constexpr std::ptrdiff_t width = 4;
#else
inline constexpr std::ptrdiff_t width = 2;
#endif

using Vector = double __attribute__((vector_size(width * sizeof(double))));

/// Loads from and stores to any address. Both compilers turn these memcpy calls into one
/// instruction. Casting the pointer is not an option, because clang ignores the alignment of its
/// type.
[[gnu::always_inline]] inline Vector load(const double* from) {
    Vector v;
    __builtin_memcpy(&v, from, sizeof v);
    return v;
}
[[gnu::always_inline]] inline void store(Vector v, double* to) {
    __builtin_memcpy(to, &v, sizeof v);
}
/// For addresses aligned to 64 bytes (base/block.hpp, AlignedVector).
[[gnu::always_inline]] inline Vector load_aligned(const double* from) {
    return load(static_cast<const double*>(__builtin_assume_aligned(from, sizeof(Vector))));
}
[[gnu::always_inline]] inline void store_aligned(Vector v, double* to) {
    store(v, static_cast<double*>(__builtin_assume_aligned(to, sizeof(Vector))));
}
/// The same value in every lane.
[[gnu::always_inline]] inline Vector all_lanes(double value) {
    return value - Vector{}; // a sum with 0 would be computed, since it changes -0
}
/// Keeps a value that is used several times in a register: g++ loads it anew for each use.
[[gnu::always_inline]] inline Vector in_register(Vector v) {
#if defined(__AVX512F__)
    asm("" : "+v"(v));
#elif defined(__SSE2__)
    asm("" : "+x"(v));
#endif
    return v;
}
/// A complex number, or two other numbers.
using Pair = double __attribute__((vector_size(2 * sizeof(double))));
[[gnu::always_inline]] inline Pair load_pair(const double* from) {
    Pair pair;
    __builtin_memcpy(&pair, from, sizeof pair);
    return pair;
}
[[gnu::always_inline]] inline void store_pair(Pair pair, double* to) {
    __builtin_memcpy(to, &pair, sizeof pair);
}
/// Two numbers in turns: a, b, a, b, ...
[[gnu::always_inline]] inline Vector load_in_turns(const double* from) {
    const Pair pair = load_pair(from);
#if defined(__AVX512F__)
    return _mm512_broadcast_f64x2(pair); // g++ 12 shuffles in halves
#elif defined(__AVX__)
    return __builtin_shufflevector(pair, pair, 0, 1, 0, 1);
#else
    return pair;
#endif
}
[[gnu::always_inline]] inline Vector reversed(Vector v) {
#if defined(__AVX512F__)
    return __builtin_shufflevector(v, v, 7, 6, 5, 4, 3, 2, 1, 0);
#elif defined(__AVX__)
    return __builtin_shufflevector(v, v, 3, 2, 1, 0);
#else
    return __builtin_shufflevector(v, v, 1, 0);
#endif
}
[[gnu::always_inline]] inline Vector greater(Vector a, Vector b) {
    return a > b ? a : b;
}
[[gnu::always_inline]] inline Vector magnitude(Vector v) {
    return v < 0.0 ? -v : v;
}

/// Load `width` interleaved complex numbers (re, im, re, im, ...) into separate vectors of real and
/// imaginary parts, and store them again, in ascending or descending order of lanes.
[[gnu::always_inline]] inline void load_ascending(const double* from, Vector& re, Vector& im) {
    const Vector a = load(from), b = load(from + width);
#if defined(__AVX512F__)
    re = __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14);
    im = __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15);
#elif defined(__AVX__)
    re = __builtin_shufflevector(a, b, 0, 2, 4, 6);
    im = __builtin_shufflevector(a, b, 1, 3, 5, 7);
#else
    re = __builtin_shufflevector(a, b, 0, 2);
    im = __builtin_shufflevector(a, b, 1, 3);
#endif
}
[[gnu::always_inline]] inline void load_descending(const double* from, Vector& re, Vector& im) {
    const Vector a = load(from), b = load(from + width);
#if defined(__AVX512F__)
    re = __builtin_shufflevector(a, b, 14, 12, 10, 8, 6, 4, 2, 0);
    im = __builtin_shufflevector(a, b, 15, 13, 11, 9, 7, 5, 3, 1);
#elif defined(__AVX__)
    re = __builtin_shufflevector(a, b, 6, 4, 2, 0);
    im = __builtin_shufflevector(a, b, 7, 5, 3, 1);
#else
    re = __builtin_shufflevector(a, b, 2, 0);
    im = __builtin_shufflevector(a, b, 3, 1);
#endif
}
[[gnu::always_inline]] inline void store_ascending(Vector re, Vector im, double* to) {
#if defined(__AVX512F__)
    store(__builtin_shufflevector(re, im, 0, 8, 1, 9, 2, 10, 3, 11), to);
    store(__builtin_shufflevector(re, im, 4, 12, 5, 13, 6, 14, 7, 15), to + width);
#elif defined(__AVX__)
    store(__builtin_shufflevector(re, im, 0, 4, 1, 5), to);
    store(__builtin_shufflevector(re, im, 2, 6, 3, 7), to + width);
#else
    store(__builtin_shufflevector(re, im, 0, 2), to);
    store(__builtin_shufflevector(re, im, 1, 3), to + width);
#endif
}
[[gnu::always_inline]] inline void store_descending(Vector re, Vector im, double* to) {
#if defined(__AVX512F__)
    store(__builtin_shufflevector(re, im, 7, 15, 6, 14, 5, 13, 4, 12), to);
    store(__builtin_shufflevector(re, im, 3, 11, 2, 10, 1, 9, 0, 8), to + width);
#elif defined(__AVX__)
    store(__builtin_shufflevector(re, im, 3, 7, 2, 6), to);
    store(__builtin_shufflevector(re, im, 1, 5, 0, 4), to + width);
#else
    store(__builtin_shufflevector(re, im, 1, 3), to);
    store(__builtin_shufflevector(re, im, 0, 2), to + width);
#endif
}

} // namespace
} // namespace shearwake::simd
