// SPDX-License-Identifier: BSD-3-Clause
#include "fft/kernels/staggered.hpp"

#include "simd/kernels.hpp"

#ifdef __SSE2__
#include <immintrin.h>
#endif

namespace shearwake::fft {
namespace {

#if defined(__AVX512F__)
constexpr std::ptrdiff_t vector_bytes = 64;
#elif defined(__AVX__)
constexpr std::ptrdiff_t vector_bytes = 32;
#else
constexpr std::ptrdiff_t vector_bytes = 16;
#endif

template <class Real>
struct VectorOf;
template <>
struct VectorOf<double> {
    using type = double __attribute__((vector_size(vector_bytes)));
};
template <>
struct VectorOf<float> {
    using type = float __attribute__((vector_size(vector_bytes)));
};
template <class Real>
using Vector = typename VectorOf<Real>::type;
template <class Real>
constexpr std::ptrdiff_t lanes = vector_bytes / static_cast<std::ptrdiff_t>(sizeof(Real));

template <class Real>
[[gnu::always_inline]] inline Vector<Real> load(const Real* from) {
    Vector<Real> v;
    __builtin_memcpy(&v, from, sizeof v);
    return v;
}
template <class Real>
[[gnu::always_inline]] inline void store(Vector<Real> v, Real* to) {
    __builtin_memcpy(to, &v, sizeof v);
}

/// (re, im, re, im ...) as (im, re, im, re ...).
template <class V>
[[gnu::always_inline]] inline V swap_parts(V v) {
    constexpr std::size_t n = sizeof v / sizeof v[0];
    if constexpr (n == 2) {
        return __builtin_shufflevector(v, v, 1, 0);
    } else if constexpr (n == 4) {
        return __builtin_shufflevector(v, v, 1, 0, 3, 2);
    } else if constexpr (n == 8) {
        return __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6);
    } else {
        static_assert(n == 16);
        return __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6, 9, 8, 11, 10, 13, 12, 15, 14);
    }
}

template <class Real>
void multiply(Real* spectra, const Real* real, const Real* imaginary, std::ptrdiff_t points,
              std::ptrdiff_t lines) {
    const std::ptrdiff_t length = 2 * points, full = length / lanes<Real> * lanes<Real>;
    for (std::ptrdiff_t l = 0; l < lines; ++l) {
        Real* s = spectra + l * length;
        for (std::ptrdiff_t i = 0; i < full; i += lanes<Real>) {
            const Vector<Real> v = load(s + i);
            store<Real>(v * load(real + i) + swap_parts(v) * load(imaginary + i), s + i);
        }
        for (std::ptrdiff_t i = full; i < length; i += 2) {
            const Real re = s[i], im = s[i + 1];
            s[i] = re * real[i] + im * imaginary[i];
            s[i + 1] = im * real[i + 1] + re * imaginary[i + 1];
        }
    }
}

template <class Real>
void join(const Real* __restrict re, const Real* __restrict im, std::ptrdiff_t points,
          Real* __restrict line) {
    for (std::ptrdiff_t i = 0; i < points; ++i) {
        line[2 * i] = re[i];
        line[2 * i + 1] = im[i];
    }
}

// Two loops: both may go to the same place.
template <class Real>
void part(const Real* __restrict line, std::ptrdiff_t points, Real* re, Real* im) {
    for (std::ptrdiff_t i = 0; i < points; ++i)
        re[i] = line[2 * i];
    for (std::ptrdiff_t i = 0; i < points; ++i)
        im[i] = line[2 * i + 1];
}

template <class Real>
void copy_rows(const Real* from, std::ptrdiff_t from_pitch, std::ptrdiff_t rows, Real* to,
               std::ptrdiff_t to_pitch) {
    constexpr std::ptrdiff_t count = row_bytes / vector_bytes;
    for (std::ptrdiff_t r = 0; r < rows; ++r, from += from_pitch, to += to_pitch) {
        Vector<Real> row[count];
        for (std::ptrdiff_t i = 0; i < count; ++i)
            row[i] = load(from + i * lanes<Real>);
        for (std::ptrdiff_t i = 0; i < count; ++i)
            store<Real>(row[i], to + i * lanes<Real>);
    }
}

/// What the language has no words for.
#if defined(__AVX512F__)
void stream(const float* from, float* to) {
    _mm512_stream_ps(to, _mm512_loadu_ps(from));
}
#elif defined(__AVX__)
void stream(const float* from, float* to) {
    _mm256_stream_ps(to, _mm256_loadu_ps(from));
}
#elif defined(__SSE2__)
void stream(const float* from, float* to) {
    _mm_stream_ps(to, _mm_loadu_ps(from));
}
#else
void stream(const float* from, float* to) {
    store<float>(load(from), to);
}
#endif

template <class Real>
void stream_rows(const Real* from, std::ptrdiff_t from_pitch, std::ptrdiff_t rows, Real* to,
                 std::ptrdiff_t to_pitch) {
    for (std::ptrdiff_t r = 0; r < rows; ++r, from += from_pitch, to += to_pitch)
        for (std::ptrdiff_t i = 0; i < row_bytes; i += vector_bytes)
            stream(reinterpret_cast<const float*>(reinterpret_cast<const char*>(from) + i),
                   reinterpret_cast<float*>(reinterpret_cast<char*>(to) + i));
}

template <class Real>
constexpr StaggeredKernels<Real> table = {multiply<Real>, join<Real>, part<Real>, copy_rows<Real>,
                                          stream_rows<Real>};

} // namespace
} // namespace shearwake::fft

namespace shearwake::simd {

template <>
const fft::StaggeredKernels<double>& compiled<fft::StaggeredKernels<double>, this_set>() {
    return fft::table<double>;
}

template <>
const fft::StaggeredKernels<float>& compiled<fft::StaggeredKernels<float>, this_set>() {
    return fft::table<float>;
}

} // namespace shearwake::simd
