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
    Planning planning() const { return planning_; }
    /// `plane` holds share().reals doubles, aligned as AlignedVector is.
    void to_physical(double* plane) const;
    void to_spectral(double* plane) const;

    std::ptrdiff_t nx() const;
    std::ptrdiff_t ny() const;

    /// Along x alone, line by line, so that a caller can work on a line while it is in the cache
    /// (run_transform.hpp makes lines). Line ky begins at 2 ky line_pitch() of lines_reals()
    /// doubles. Not collective.
    void line_to_spectral(double* line) const;
    void line_to_physical(double* line) const;
    std::ptrdiff_t line_pitch() const;
    std::ptrdiff_t lines_reals() const { return lines_reals(share_.ky_count); }
    std::ptrdiff_t lines_reals(std::ptrdiff_t lines) const;

private:
    friend class RunTransform;
    struct Work;
    std::unique_ptr<Work> work_;
    SlabShare share_;
    Planning planning_;
};

} // namespace shearwake
