#include "fft/slab_transform.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <fftw3-mpi.h>
#include <type_traits>

namespace shearwake {
namespace {

struct Destroy {
    void operator()(fftw_plan p) const { fftw_destroy_plan(p); }
};
using Plan = std::unique_ptr<std::remove_pointer_t<fftw_plan>, Destroy>;

Plan checked(fftw_plan raw) {
    if (!raw) throw Error("FFTW refused to make a plan");
    return Plan(raw);
}

fftw_complex* complexes(double* plane) {
    return reinterpret_cast<fftw_complex*>(plane);
}

} // namespace

struct SlabTransform::Plans {
    Plan physical, spectral;
};

// One plane at a time: interleaving several planes (howmany 4, 8) was slower on 1 and 2 ranks
// (256 x 192: 0.25 ms a plane alone, 0.32 and 0.27 interleaved). On one rank FFTW3-MPI is as fast
// as the plain library with the same strides, so there is one path for any number of ranks.
SlabTransform::SlabTransform(std::ptrdiff_t nx, std::ptrdiff_t ny, const Comm& team,
                             Planning planning)
    : plans_(std::make_unique<Plans>()) {
    fftw_mpi_init();
    const std::ptrdiff_t modes = ny / 2 + 1;
    const std::ptrdiff_t n[2] = {nx, modes};
    const std::ptrdiff_t values = fftw_mpi_local_size_many_transposed(
        2, n, 1, FFTW_MPI_DEFAULT_BLOCK, FFTW_MPI_DEFAULT_BLOCK, team.raw(), &share_.x_count,
        &share_.x_start, &share_.ky_count, &share_.ky_start);
    share_.padded_ny = 2 * modes;
    // An odd number of cache lines of 64 bytes: every plane of a pile is aligned as the first, and
    // the same point of all planes does not fall into the same few sets of the cache.
    const std::ptrdiff_t line = 8;
    const std::ptrdiff_t lines = (2 * std::max<std::ptrdiff_t>(values, 1) + line - 1) / line;
    share_.reals = line * (lines | 1);
    AlignedVector<double> scratch(static_cast<std::size_t>(share_.reals));
    double* plane = scratch.data();
    const unsigned effort = planning == Planning::measured ? FFTW_MEASURE : FFTW_ESTIMATE;
    plans_->physical = checked(fftw_mpi_plan_dft_c2r_2d(nx, ny, complexes(plane), plane, team.raw(),
                                                        effort | FFTW_MPI_TRANSPOSED_IN));
    plans_->spectral = checked(fftw_mpi_plan_dft_r2c_2d(nx, ny, plane, complexes(plane), team.raw(),
                                                        effort | FFTW_MPI_TRANSPOSED_OUT));
}

SlabTransform::~SlabTransform() = default;

void SlabTransform::to_physical(double* plane) const {
    fftw_mpi_execute_dft_c2r(plans_->physical.get(), complexes(plane), plane);
}

void SlabTransform::to_spectral(double* plane) const {
    fftw_mpi_execute_dft_r2c(plans_->spectral.get(), plane, complexes(plane));
}

void SlabTransform::to_physical(double* planes, std::ptrdiff_t count) const {
    for (std::ptrdiff_t n = 0; n < count; ++n)
        to_physical(planes + n * share_.reals);
}

void SlabTransform::to_spectral(double* planes, std::ptrdiff_t count) const {
    for (std::ptrdiff_t n = 0; n < count; ++n)
        to_spectral(planes + n * share_.reals);
}

} // namespace shearwake
