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

/// Inverse transform of one real plane, distributed over a team in slabs (FFTW3-MPI):
///     f(x, y) = sum over kx, ky of F(ky, kx) e^{i (kx x + ky y)}, unnormalised, in place;
/// spectrum rows are ky (the non-negative half), contiguous in kx; physical rows are x,
/// contiguous in y with padding. Collective: construction and `execute`, surplus ranks too.
class SlabTransform {
public:
    SlabTransform(std::ptrdiff_t nx, std::ptrdiff_t ny, const Comm& team);
    ~SlabTransform();
    SlabTransform(const SlabTransform&) = delete;
    SlabTransform& operator=(const SlabTransform&) = delete;

    const SlabShare& share() const { return share_; }
    /// `plane` holds share().reals doubles, aligned as AlignedVector is.
    void execute(double* plane) const;

private:
    struct Plan;
    std::unique_ptr<Plan> plan_;
    SlabShare share_;
};

} // namespace shearwake
