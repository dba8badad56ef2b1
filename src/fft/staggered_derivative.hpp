#pragma once

#include "fft/aligned.hpp"
#include "fft/fftw_real.hpp"
#include "parallel/comm.hpp"

#include <algorithm>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <cstring>

#ifdef __AVX__
#include <immintrin.h>
#endif

namespace shearwake {

/// Where the derivative stands relative to its input: half a cell on (+) or half a cell back (-).
enum class HalfCell { forward, back };

/// The spectral derivative of periodic real lines, shifted by half a cell,
///     D f = Re IFFT[ i k exp(+- i k d/2) FFT f ],   k = 2 pi m / (n d),
/// with the Nyquist mode of even n kept: its factor is real, -pi/d forward and +pi/d back
/// (k-Wave's ddx_k_shift_pos and _neg). Two real lines are the real and the imaginary part of a
/// complex one: the factor is that of a real operator, so they do not mix. Lines are transformed
/// `width` at a time within the first level of the cache.
///
/// 128 points, ns a point there and back: 0.85; FFTW's real transforms of contiguous lines 1.3, of
/// strided ones 12.
template <class Real>
class StaggeredDerivative {
public:
    using Complex = std::complex<Real>;
    /// Complex lines that are transformed together: 128 bytes of each point.
    static constexpr std::ptrdiff_t width = 128 / static_cast<std::ptrdiff_t>(sizeof(Complex));

    /// Collective: measures plans or recalls them (fft/wisdom.hpp).
    StaggeredDerivative(std::ptrdiff_t points, double spacing_m, const Comm& team);

    std::ptrdiff_t points() const { return points_; }

    /// The block of `width` complex columns, points() rows: fill it, differentiate, read it.
    Complex* block() { return block_.data(); }
    void differentiate_block(HalfCell shift);
    /// FFTW alone, there and back: what a derivative's transforms take at the least.
    void transform_block();

    /// Along the rows' slow axis: columns [0, columns) of a matrix of points() rows. `columns` is
    /// even and so are the pitches [reals].
    void along_columns(HalfCell shift, const Real* from, std::ptrdiff_t from_pitch, Real* to,
                       std::ptrdiff_t to_pitch, std::ptrdiff_t columns);
    /// Along contiguous rows of points() values each, `pitch` apart.
    void along_rows(HalfCell shift, const Real* from, Real* to, std::ptrdiff_t pitch,
                    std::ptrdiff_t rows);

    /// Copies a row of the block, 2 width reals, or the first `count` of them; stream_row does not
    /// read what it overwrites into the cache: for what is not needed soon.
    static void stream_row(const Real* from, std::ptrdiff_t count, Real* to) {
#ifdef __AVX__ // what a portable program cannot say
        if (count == 2 * width && reinterpret_cast<std::uintptr_t>(to) % 32 == 0) {
            const char* source = reinterpret_cast<const char*>(from);
            char* target = reinterpret_cast<char*>(to);
            for (std::size_t i = 0; i < 2 * width * sizeof(Real); i += 32)
                _mm256_stream_si256(
                    reinterpret_cast<__m256i*>(target + i),
                    _mm256_loadu_si256(reinterpret_cast<const __m256i*>(source + i)));
            return;
        }
#endif
        copy_row(from, count, to);
    }
    static void copy_row(const Real* from, std::ptrdiff_t count, Real* to) {
        if (count == 2 * width)
            std::memcpy(to, from, 2 * width * sizeof(Real)); // of a known size: no call
        else
            std::copy_n(from, count, to);
    }

private:
    using Fftw = FftwOf<Real>;
    bool plan(unsigned flags);
    void multiply(HalfCell shift);

    std::ptrdiff_t points_;
    AlignedVector<Complex> block_, lines_, spectra_; // [points][width], [width][points] twice
    AlignedVector<Complex> forward_factor_, back_factor_;
    typename Fftw::Plan columns_to_spectra_, spectra_to_columns_, lines_to_spectra_,
        spectra_to_lines_;
};

} // namespace shearwake
