#pragma once

#include "fft/aligned.hpp"
#include "parallel/comm.hpp"

#include <complex>
#include <cstddef>
#include <memory>

namespace shearwake {

/// Which part of a slab-decomposed plane this rank has. Surplus ranks have none (counts of 0).
struct SlabShare {
    std::ptrdiff_t x_start = 0, x_count = 0;   // rows of the physical plane
    std::ptrdiff_t ky_start = 0, ky_count = 0; // rows of the transposed spectrum, of ny/2 + 1
    std::ptrdiff_t padded_ny = 0;              // values from one physical row to the next
    std::ptrdiff_t reals = 0;                  // doubles that one plane's buffer needs
};

/// Rows [begin, end) of the x_count physical rows that a rank has.
struct SlabRows {
    std::ptrdiff_t begin = 0, end = 0;
};

/// How FFTW chooses its plan: from a model of the machine, the same every time; or by measuring.
enum class Planning { estimated, measured };

/// Transforms of a real plane, distributed over a team in slabs, unnormalised, in place:
///     to_physical:  f(x, y)   = sum over kx, ky of F(ky, kx) e^{+i (kx x + ky y)}
///     to_spectral:  F(ky, kx) = sum over x, y   of f(x, y)   e^{-i (kx x + ky y)}
/// so that one after the other is nx ny times the plane. Spectrum rows are ky (the non-negative
/// half), contiguous in kx; physical rows are x, contiguous in y, padded to `padded_ny` with values
/// that do not matter. The bits do not depend on the number of ranks. Keeps a plane or two of its
/// own. Collective: construction and transforms, surplus ranks too.
///
/// 256 x 192, ns a point there and back, 1 / 2 ranks: estimated 3.8 / 2.6, measured 3.4 to 4.0
/// / 2.5 to 2.7 (each time another plan); FFTW's own 2-D plans 6.1 / 3.9, measured 4.1 to 4.8 / 2.5
/// to 3.0.
class SlabTransform {
public:
    SlabTransform(std::ptrdiff_t nx, std::ptrdiff_t ny, const Comm& team,
                  Planning planning = Planning::estimated);
    ~SlabTransform();
    SlabTransform(const SlabTransform&) = delete;
    SlabTransform& operator=(const SlabTransform&) = delete;

    const SlabShare& share() const { return share_; }
    /// `plane` holds share().reals doubles, aligned as AlignedVector is. Where only some rows
    /// matter, up to half of the work is saved by naming them: to_physical leaves the others
    /// undefined, to_spectral takes them for zero and does not read them.
    void to_physical(double* plane, SlabRows wanted) const;
    void to_spectral(double* plane, SlabRows given) const;
    void to_physical(double* plane) const { to_physical(plane, all_rows()); }
    void to_spectral(double* plane) const { to_spectral(plane, all_rows()); }
    SlabRows all_rows() const { return {0, share_.x_count}; }

private:
    struct Work;
    std::unique_ptr<Work> work_;
    SlabShare share_;
};

} // namespace shearwake
