// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fft/fftw_real.hpp"
#include "fft/slab_transform.hpp"

#include <type_traits>
#include <vector>

namespace shearwake::fft {

// Internals shared by SlabTransform and RunTransform; private to this folder.

using Complex = std::complex<double>;

/// Number of rows that are transposed together: four complex numbers fill one cache line.
constexpr std::ptrdiff_t width = 4;

inline fftw_complex* raw(Complex* values) {
    return reinterpret_cast<fftw_complex*>(values);
}

/// Calls copy(number of rows) with a compile-time constant for 1 to `complete` rows, so that copies
/// of so few rows become moves of registers.
template <std::ptrdiff_t complete, class Copy>
void with_constant(std::ptrdiff_t count, const Copy& copy) {
    if constexpr (complete > 0) {
        if (count == complete) return copy(std::integral_constant<std::ptrdiff_t, complete>());
        with_constant<complete - 1>(count, copy);
    }
}

/// columns[k * stride + r] = rows[r * pitch + k] for `count` rows of `length`.
inline void rows_to_columns(const Complex* rows, std::ptrdiff_t pitch, std::ptrdiff_t count,
                            std::ptrdiff_t length, Complex* columns, std::ptrdiff_t stride) {
    with_constant<width>(count, [&](auto rows_together) {
        for (std::ptrdiff_t k = 0; k < length; ++k)
            for (std::ptrdiff_t r = 0; r < rows_together; ++r)
                columns[k * stride + r] = rows[r * pitch + k];
    });
}

/// The inverse: rows[r * pitch + k] = columns[k * stride + r].
inline void columns_to_rows(const Complex* columns, std::ptrdiff_t stride, std::ptrdiff_t count,
                            std::ptrdiff_t length, Complex* rows, std::ptrdiff_t pitch) {
    with_constant<width>(count, [&](auto rows_together) {
        for (std::ptrdiff_t k = 0; k < length; ++k)
            for (std::ptrdiff_t r = 0; r < rows_together; ++r)
                rows[r * pitch + k] = columns[k * stride + r];
    });
}

struct SlabTransform::Work {
    std::ptrdiff_t nx, ny, modes, pitch, stride;
    std::ptrdiff_t line_pitch;
    AlignedVector<Complex> lines_, columns_, rows_;
    AlignedVector<double> row_; // one physical row
    /// One row of the spectrum, before and after the transform along x.
    AlignedVector<Complex> filled_, turned_;
    AlignedVector<Complex> sent_, received_; // buffers for rows that are exchanged between ranks
    /// The part of a plane that each rank has.
    struct Other {
        std::ptrdiff_t x_start, x_count, ky_start, ky_count;
    };
    std::vector<Other> ranks;
    /// Complex numbers that to_physical exchanges with each rank; 0 for this rank.
    std::vector<std::ptrdiff_t> to_ranks, from_ranks;
    /// Complex numbers of the row at the Nyquist frequency that to_spectral exchanges with each
    /// rank; empty on one rank and for odd ny. The row is empty on ranks that do not have it.
    std::vector<std::ptrdiff_t> nyquist_to_ranks, nyquist_from_ranks;
    AlignedVector<Complex> nyquist_row_;
    std::size_t me = 0;
    FftwPlan y_to_spectral, y_to_physical, x_to_spectral, x_to_physical;
    FftwPlan line_to_spectral, line_to_physical; // along x in place
    FftwPlan slabs_to_spectral;                  // empty on one rank

    Complex* columns() { return columns_.data(); }
    Complex* rows() { return rows_.empty() ? columns_.data() : rows_.data(); }
    Complex* line(std::ptrdiff_t r) { return lines_.data() + r * pitch; }
    bool alone() const { return !slabs_to_spectral; }

    void row_to_physical(Complex* row, std::ptrdiff_t k);
    void gather_lines(std::ptrdiff_t i, std::ptrdiff_t count);
    void send_nyquist_row(const Comm& team);
    void gather_shares(const SlabShare& share, const Comm& team);
    bool plan_lines(double* plane, unsigned flags); // returns whether FFTW could create them
    void plan_slabs(const Comm& team, unsigned effort);
};

} // namespace shearwake::fft
