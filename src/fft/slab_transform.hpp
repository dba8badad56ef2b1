// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fft/aligned.hpp"
#include "parallel/comm.hpp"

#include <complex>
#include <cstddef>
#include <functional>
#include <memory>

namespace shearwake::fft {

/// The part of a slab-decomposed plane that belongs to this rank. Surplus ranks have counts of 0.
struct SlabShare {
    std::ptrdiff_t x_start = 0, x_count = 0;   // rows of the physical plane
    std::ptrdiff_t ky_start = 0, ky_count = 0; // rows of the transposed spectrum, of ny/2 + 1
    std::ptrdiff_t padded_ny = 0;              // distance of consecutive physical rows in values
    std::ptrdiff_t reals = 0;                  // size of the buffer of one plane in doubles
};

/// How FFTW chooses its plans: from a model of the machine (reproducible) or by measuring.
enum class Planning { estimated, measured };

/// Number of rows of the spectrum below the Nyquist frequency of y, which only an even ny has.
/// Further ranks have no rows. Not collective.
std::ptrdiff_t below_nyquist(std::ptrdiff_t ny);
/// Number of rows of the spectrum on the rank with most of them. Not collective.
std::ptrdiff_t most_rows(std::ptrdiff_t ny, int ranks);

/// Unnormalised in-place transforms of a real plane of nx by ny points, distributed over a team in
/// slabs:
///     to_physical:  f(x, y)   = sum over kx, ky of F(ky, kx) e^{+i (kx x + ky y)}
///     to_spectral:  F(ky, kx) = sum over x, y   of f(x, y)   e^{-i (kx x + ky y)}
/// One after the other multiplies the plane by nx ny. Rows of the spectrum are ky (ny/2 + 1
/// non-negative ones), contiguous in kx. Physical rows are x, contiguous in y and padded to
/// `padded_ny` with arbitrary values. The rows of the spectrum below the Nyquist frequency of y are
/// distributed evenly; the rank with the last of them also has the row at that frequency. The bits
/// do not depend on the number of ranks. Needs memory for one or two additional planes.
/// Construction and transforms are collective and include surplus ranks.
///
/// Measured time of a plane of 256 x 192 points in both directions, in ns per point on 1 / 2 ranks:
/// estimated 3.8 / 2.6, measured 3.4 to 4.0 / 2.5 to 2.7 (each run measures another plan). FFTW's
/// own 2-D plans: estimated 6.1 / 3.9, measured 4.1 to 4.8 / 2.5 to 3.0.
class SlabTransform {
public:
    SlabTransform(std::ptrdiff_t nx, std::ptrdiff_t ny, const Comm& team,
                  Planning planning = Planning::estimated);
    ~SlabTransform();
    SlabTransform(const SlabTransform&) = delete;
    SlabTransform& operator=(const SlabTransform&) = delete;

    const SlabShare& share() const { return share_; }
    Planning planning() const { return planning_; }
    /// `plane` holds share().reals doubles and is aligned as AlignedVector.
    void to_physical(double* plane) const;
    /// Computes each row of the spectrum just before it is transformed: fill(row, line) writes the
    /// nx values of this rank's local row to `line`.
    using FillRow = std::function<void(std::ptrdiff_t row, std::complex<double>* line)>;
    void to_physical(const FillRow& fill, double* plane) const;
    void to_spectral(double* plane) const;

    std::ptrdiff_t nx() const;
    std::ptrdiff_t ny() const;

    /// Transforms one line of nx complex numbers along x, so that callers can process a line while
    /// it is in the cache (RunTransform provides the lines). Line ky begins at double 2 ky
    /// line_pitch() of a buffer of lines_reals() doubles. Not collective.
    void line_to_spectral(double* line) const;
    void line_to_physical(double* line) const;
    std::ptrdiff_t line_pitch() const;
    std::ptrdiff_t lines_reals() const { return lines_reals(share_.ky_count); }
    std::ptrdiff_t lines_reals(std::ptrdiff_t lines) const;

private:
    friend class RunTransform;
    struct Work;
    void finish_physical(double* plane) const;
    std::unique_ptr<Work> work_;
    SlabShare share_;
    Planning planning_;
    Comm team_;
};

} // namespace shearwake::fft
