// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fft/aligned.hpp"
#include "fft/fftw_real.hpp"
#include "fft/kernels/staggered.hpp"
#include "parallel/comm.hpp"

#include <complex>
#include <cstddef>

namespace shearwake::fft {

/// Shift of the derivative relative to its input: by half a cell forward (+) or back (-).
enum class HalfCell { forward, back };

/// Spectral derivative of periodic real lines of n points with spacing d, shifted by half a cell,
///     D f = Re IFFT[ i k exp(+- i k d/2) FFT f ],   k = 2 pi m / (n d).
/// The Nyquist mode of even n is kept: its factor is real, -pi/d forward and +pi/d back (k-Wave's
/// ddx_k_shift_pos and _neg). Two real lines form the real and the imaginary part of a complex
/// line. They do not mix because the operator is real. Lines are transformed `width` at a time
/// within the first-level cache.
///
/// Measured time of both directions for 128 points: 0.85 ns per point; FFTW's real transforms take
/// 1.3 ns for contiguous and 12 ns for strided lines.
template <class Real>
class StaggeredDerivative {
public:
    using Complex = std::complex<Real>;
    /// Complex lines that are transformed together: a row of the block holds a point of each.
    static constexpr std::ptrdiff_t width =
        row_bytes / static_cast<std::ptrdiff_t>(sizeof(Complex));

    /// `points` per line, spacing in metres. Loads measured FFTW plans or measures them
    /// (fft/wisdom.hpp). Collective.
    StaggeredDerivative(std::ptrdiff_t points, double spacing_m, const Comm& team);

    std::ptrdiff_t points() const { return points_; }

    /// A buffer of points() rows of `width` complex columns, which differentiate_block()
    /// differentiates in place. Not collective.
    Complex* block() { return block_.data(); }
    void differentiate_block(HalfCell shift);
    /// Runs the two transforms of a derivative alone: a lower bound on its time for benchmarks.
    void transform_block();

    /// Differentiates columns [0, columns) of a matrix of points() rows along the slow axis.
    /// `columns` and the pitches (numbers of reals) are even. Not collective.
    void along_columns(HalfCell shift, const Real* from, std::ptrdiff_t from_pitch, Real* to,
                       std::ptrdiff_t to_pitch, std::ptrdiff_t columns);
    /// Differentiates `rows` contiguous rows of points() values, which begin `pitch` values apart.
    /// Not collective.
    void along_rows(HalfCell shift, const Real* from, Real* to, std::ptrdiff_t pitch,
                    std::ptrdiff_t rows);

    /// Copies `rows` rows of the block, 2 width reals or the first `count` of each; stream_rows
    /// does not read what it overwrites into the cache: for what is not needed soon, in lines of
    /// the cache.
    void copy_rows(const Real* from, std::ptrdiff_t from_pitch, std::ptrdiff_t rows,
                   std::ptrdiff_t count, Real* to, std::ptrdiff_t to_pitch) const;
    void stream_rows(const Real* from, std::ptrdiff_t from_pitch, std::ptrdiff_t rows,
                     std::ptrdiff_t count, Real* to, std::ptrdiff_t to_pitch) const;

private:
    using Fftw = FftwOf<Real>;
    /// i k exp(+- i k d/2) / n, as StaggeredKernels::multiply takes it.
    struct Factor {
        AlignedVector<Real> real, imaginary;
    };
    bool plan(unsigned flags);
    void multiply(HalfCell shift);
    static void set(Factor& factor, std::ptrdiff_t mode, std::complex<double> value);

    const StaggeredKernels<Real>* kernels_;
    std::ptrdiff_t points_;
    AlignedVector<Complex> block_, lines_, spectra_; // [points][width], [width][points] twice
    Factor forward_factor_, back_factor_;
    typename Fftw::Plan columns_to_spectra_, spectra_to_columns_, lines_to_spectra_,
        spectra_to_lines_;
};

} // namespace shearwake::fft
