#include "fft/slab_transform.hpp"

#include "fft/slab_work.hpp"
#include "fft/wisdom.hpp"

#include <algorithm>
#include <fftw3-mpi.h>
#include <string>

namespace shearwake {
namespace {

/// An odd number of cache lines of 64 bytes: every plane of a pile is aligned as the first, and the
/// same point of all planes does not fall into the same few sets of the cache.
std::ptrdiff_t odd_lines(std::ptrdiff_t reals) {
    const std::ptrdiff_t line = 8;
    return line * (((reals + line - 1) / line) | 1);
}

} // namespace

// to_spectral, plane by plane (to_physical runs the same steps back):
//  1. a few rows at a time r2c along y into `lines_`, from there transposed into `columns_`:
//     all ky of this rank's x, contiguous in x;
//  2. FFTW3-MPI transposes those among the ranks into `rows_`: this rank's ky, all x (one rank:
//  none);
//  3. along x, from `rows_` back into the plane.
// Every line has the same plan, so the bits do not depend on the number of ranks.
bool SlabTransform::Work::plan_lines(double* plane, unsigned flags) {
    const int x = static_cast<int>(nx), y = static_cast<int>(ny);
    auto* modes_of_plane = reinterpret_cast<fftw_complex*>(plane);
    // Lines begin at any complex number; FFTW's vector code may want more than that.
    const bool aligned = fftw_alignment_of(plane + 2) == fftw_alignment_of(plane);
    flags |= FFTW_DESTROY_INPUT | (aligned ? 0U : FFTW_UNALIGNED);
    y_to_spectral.reset(fftw_plan_dft_r2c_1d(y, plane, raw(line(0)), flags));
    y_to_physical.reset(fftw_plan_dft_c2r_1d(y, raw(line(0)), plane, flags));
    x_to_spectral.reset(fftw_plan_dft_1d(x, raw(rows()), modes_of_plane, FFTW_FORWARD, flags));
    x_to_physical.reset(fftw_plan_dft_1d(x, modes_of_plane, raw(rows()), FFTW_BACKWARD, flags));
    line_to_spectral.reset(
        fftw_plan_dft_1d(x, modes_of_plane, modes_of_plane, FFTW_FORWARD, flags));
    line_to_physical.reset(
        fftw_plan_dft_1d(x, modes_of_plane, modes_of_plane, FFTW_BACKWARD, flags));
    return y_to_spectral && y_to_physical && x_to_spectral && x_to_physical && line_to_spectral &&
           line_to_physical;
}

void SlabTransform::Work::plan_slabs(const Comm& team, unsigned effort) {
    const unsigned flags = effort | FFTW_DESTROY_INPUT;
    auto* by_x = reinterpret_cast<double*>(columns());
    auto* by_ky = reinterpret_cast<double*>(rows());
    slabs_to_spectral = checked_plan(
        fftw_mpi_plan_many_transpose(nx, modes, 2, FFTW_MPI_DEFAULT_BLOCK, FFTW_MPI_DEFAULT_BLOCK,
                                     by_x, by_ky, team.raw(), flags | FFTW_MPI_TRANSPOSED_IN));
    slabs_to_physical = checked_plan(
        fftw_mpi_plan_many_transpose(modes, nx, 2, FFTW_MPI_DEFAULT_BLOCK, FFTW_MPI_DEFAULT_BLOCK,
                                     by_ky, by_x, team.raw(), flags | FFTW_MPI_TRANSPOSED_OUT));
}

SlabTransform::SlabTransform(std::ptrdiff_t nx, std::ptrdiff_t ny, const Comm& team,
                             Planning planning)
    : work_(std::make_unique<Work>()), planning_(planning) {
    fftw_mpi_init();
    const std::ptrdiff_t modes = ny / 2 + 1;
    const std::ptrdiff_t n[2] = {nx, modes};
    const std::ptrdiff_t values = fftw_mpi_local_size_many_transposed(
        2, n, 1, FFTW_MPI_DEFAULT_BLOCK, FFTW_MPI_DEFAULT_BLOCK, team.raw(), &share_.x_count,
        &share_.x_start, &share_.ky_count, &share_.ky_start);
    share_.padded_ny = 2 * modes;
    share_.reals = odd_lines(2 * std::max<std::ptrdiff_t>({values, nx, modes}));

    Work& w = *work_;
    w.nx = nx, w.ny = ny, w.modes = modes;
    w.pitch = modes + 3;                  // so that lines do not share their cache sets
    w.line_pitch = odd_lines(2 * nx) / 2; // likewise
    w.lines_.resize(static_cast<std::size_t>(width * w.pitch));
    w.row_.resize(static_cast<std::size_t>(share_.padded_ny));
    const bool alone = team.size() == 1;
    w.stride =
        alone ? nx + width : share_.x_count; // likewise, where FFTW-MPI does not prescribe it
    const auto room = static_cast<std::size_t>(
        std::max(share_.reals / 2, alone ? w.stride * modes : std::ptrdiff_t{0}));
    w.columns_.resize(room);
    if (!alone) w.rows_.resize(room);

    AlignedVector<double> plane(static_cast<std::size_t>(share_.reals));
    const auto lines = [&](unsigned flags) { return w.plan_lines(plane.data(), flags); };
    const bool measured = planning == Planning::measured;
    if (measured)
        plan_measured(team, std::to_string(nx) + "x" + std::to_string(ny), lines);
    else
        plan_estimated(lines);
    // Transposing moves numbers and changes none, so that these plans need not be kept.
    if (!alone) w.plan_slabs(team, measured ? FFTW_MEASURE : FFTW_ESTIMATE);
    fftw_forget_wisdom();
}

SlabTransform::~SlabTransform() = default;

void SlabTransform::to_physical(double* plane) const {
    Work& w = *work_;
    auto* modes = reinterpret_cast<Complex*>(plane);
    const std::ptrdiff_t line_of_x = w.slabs_to_physical ? w.nx : w.stride;
    for (std::ptrdiff_t k = 0; k < share_.ky_count; ++k)
        fftw_execute_dft(w.x_to_physical.get(), raw(modes + k * w.nx),
                         raw(w.rows() + k * line_of_x));
    if (w.slabs_to_physical) fftw_execute(w.slabs_to_physical.get());
    for (std::ptrdiff_t i = 0; i < share_.x_count; i += width) {
        const std::ptrdiff_t count = std::min(width, share_.x_count - i);
        columns_to_rows(w.columns() + i, w.stride, count, w.modes, w.line(0), w.pitch);
        for (std::ptrdiff_t r = 0; r < count; ++r)
            fftw_execute_dft_c2r(w.y_to_physical.get(), raw(w.line(r)),
                                 plane + (i + r) * share_.padded_ny);
    }
}

void SlabTransform::to_spectral(double* plane) const {
    Work& w = *work_;
    auto* modes = reinterpret_cast<Complex*>(plane);
    const std::ptrdiff_t line_of_x = w.slabs_to_spectral ? w.nx : w.stride;
    for (std::ptrdiff_t i = 0; i < share_.x_count; i += width) {
        const std::ptrdiff_t count = std::min(width, share_.x_count - i);
        for (std::ptrdiff_t r = 0; r < count; ++r)
            fftw_execute_dft_r2c(w.y_to_spectral.get(), plane + (i + r) * share_.padded_ny,
                                 raw(w.line(r)));
        rows_to_columns(w.line(0), w.pitch, count, w.modes, w.columns() + i, w.stride);
    }
    if (w.slabs_to_spectral) fftw_execute(w.slabs_to_spectral.get());
    for (std::ptrdiff_t k = 0; k < share_.ky_count; ++k)
        fftw_execute_dft(w.x_to_spectral.get(), raw(w.rows() + k * line_of_x),
                         raw(modes + k * w.nx));
}

std::ptrdiff_t SlabTransform::nx() const {
    return work_->nx;
}

std::ptrdiff_t SlabTransform::ny() const {
    return work_->ny;
}

std::ptrdiff_t SlabTransform::line_pitch() const {
    return work_->line_pitch;
}

std::ptrdiff_t SlabTransform::lines_reals(std::ptrdiff_t lines) const {
    return odd_lines(2 * lines * work_->line_pitch);
}

void SlabTransform::line_to_spectral(double* line) const {
    auto* modes = reinterpret_cast<fftw_complex*>(line);
    fftw_execute_dft(work_->line_to_spectral.get(), modes, modes);
}

void SlabTransform::line_to_physical(double* line) const {
    auto* modes = reinterpret_cast<fftw_complex*>(line);
    fftw_execute_dft(work_->line_to_physical.get(), modes, modes);
}

} // namespace shearwake
