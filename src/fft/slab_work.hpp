#pragma once

#include "fft/fftw_plan.hpp"
#include "fft/slab_transform.hpp"

#include <type_traits>

namespace shearwake {

// What the transforms of planes and of runs of rows share; for this folder alone.

using Complex = std::complex<double>;

/// Rows that are transposed together: four complex numbers are one line of the cache.
constexpr std::ptrdiff_t width = 4;

inline fftw_complex* raw(Complex* values) {
    return reinterpret_cast<fftw_complex*>(values);
}

/// columns[k * stride + r] = rows[r * pitch + k] for `count` rows of `length`.
inline void rows_to_columns(const Complex* rows, std::ptrdiff_t pitch, std::ptrdiff_t count,
                            std::ptrdiff_t length, Complex* columns, std::ptrdiff_t stride) {
    const auto copy = [&](auto rows_together) {
        for (std::ptrdiff_t k = 0; k < length; ++k)
            for (std::ptrdiff_t r = 0; r < rows_together; ++r)
                columns[k * stride + r] = rows[r * pitch + k];
    };
    if (count == width) return copy(std::integral_constant<std::ptrdiff_t, width>()); // unrolled
    copy(count);
}

/// The way back: rows[r * pitch + k] = columns[k * stride + r].
inline void columns_to_rows(const Complex* columns, std::ptrdiff_t stride, std::ptrdiff_t count,
                            std::ptrdiff_t length, Complex* rows, std::ptrdiff_t pitch) {
    const auto copy = [&](auto rows_together) {
        for (std::ptrdiff_t k = 0; k < length; ++k)
            for (std::ptrdiff_t r = 0; r < rows_together; ++r)
                rows[r * pitch + k] = columns[k * stride + r];
    };
    if (count == width) return copy(std::integral_constant<std::ptrdiff_t, width>());
    copy(count);
}

struct SlabTransform::Work {
    std::ptrdiff_t nx, ny, modes, pitch, stride;
    std::ptrdiff_t line_pitch;
    AlignedVector<Complex> lines_, columns_, rows_;
    AlignedVector<double> row_;              // one physical row
    AlignedVector<Complex> sent_, received_; // of the rows that go from rank to rank
    FftwPlan y_to_spectral, y_to_physical, x_to_spectral, x_to_physical;
    FftwPlan line_to_spectral, line_to_physical;   // along x in place
    FftwPlan slabs_to_spectral, slabs_to_physical; // none on one rank

    Complex* columns() { return columns_.data(); }
    Complex* rows() { return rows_.empty() ? columns_.data() : rows_.data(); }
    Complex* line(std::ptrdiff_t r) { return lines_.data() + r * pitch; }
    bool alone() const { return !slabs_to_spectral; }

    bool plan_lines(double* plane, unsigned flags); // whether FFTW could
    void plan_slabs(const Comm& team, unsigned effort);
};

} // namespace shearwake
