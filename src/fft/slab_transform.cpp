// SPDX-License-Identifier: BSD-3-Clause
#include "fft/slab_transform.hpp"

#include "fft/slab_work.hpp"
#include "fft/wisdom.hpp"

#include <algorithm>
#include <fftw3-mpi.h>
#include <string>

namespace shearwake::fft {
namespace {

/// Rounds up to an odd number of 64-byte cache lines. Every plane of a stack is then aligned like
/// the first one, and corresponding points of the planes do not map to the same few cache sets.
std::ptrdiff_t odd_lines(std::ptrdiff_t reals) {
    const std::ptrdiff_t line = 8;
    return line * (((reals + line - 1) / line) | 1);
}

} // namespace

std::ptrdiff_t below_nyquist(std::ptrdiff_t ny) {
    return (ny + 1) / 2;
}

std::ptrdiff_t most_rows(std::ptrdiff_t ny, int ranks) {
    const std::ptrdiff_t below = below_nyquist(ny), block = (below + ranks - 1) / ranks;
    return block + (ny % 2 == 0 && below % block == 0 ? 1 : 0);
}

// to_spectral processes a plane in three steps:
//  1. r2c along y, a few rows at a time, into `lines_`, transposed from there into `columns_`:
//     all ky of this rank's x, contiguous in x;
//  2. global transpose by FFTW3-MPI into `rows_`: this rank's ky, all x (omitted on one rank);
//  3. transform along x from `rows_` back into the plane.
// The row at the Nyquist frequency of y is usually zero. FFTW distributes only the rows below it,
// so that the work is even; the rank with the last of these has it in addition and receives it
// separately.
// to_physical runs the steps in reverse order, except for the transpose. Each row is copied to the
// send buffer while it is in the cache, data of this rank is not moved, and the lines along y are
// gathered from the received data. The transpose of FFTW3-MPI would take two more passes over the
// plane. All lines use the same plan, so the bits do not depend on the number of ranks.
bool SlabTransform::Work::plan_lines(double* plane, unsigned flags) {
    const int x = static_cast<int>(nx), y = static_cast<int>(ny);
    auto* modes_of_plane = reinterpret_cast<fftw_complex*>(plane);
    // A line may begin at any complex number, which has a weaker alignment than FFTW's vector code
    // may require.
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
    team.before_collective();
    slabs_to_spectral = checked_plan(fftw_mpi_plan_many_transpose(
        nx, below_nyquist(ny), 2, FFTW_MPI_DEFAULT_BLOCK, FFTW_MPI_DEFAULT_BLOCK,
        reinterpret_cast<double*>(columns()), reinterpret_cast<double*>(rows()), team.raw(),
        flags | FFTW_MPI_TRANSPOSED_IN));
}

void SlabTransform::Work::gather_shares(const SlabShare& share, const Comm& team) {
    me = static_cast<std::size_t>(team.rank());
    const std::vector<long> all = team.all_gather(
        std::vector<long>{share.x_start, share.x_count, share.ky_start, share.ky_count});
    std::ptrdiff_t sent = 0, received = 0;
    for (std::size_t at = 0; at < all.size(); at += 4) {
        const Other of{all[at], all[at + 1], all[at + 2], all[at + 3]};
        const bool other = ranks.size() != me;
        to_ranks.push_back(other ? share.ky_count * of.x_count : 0);
        from_ranks.push_back(other ? share.x_count * of.ky_count : 0);
        sent += to_ranks.back();
        received += from_ranks.back();
        ranks.push_back(of);
    }
    if (modes > below_nyquist(ny)) {
        const bool is_owner = share.ky_count > 0 && share.ky_start + share.ky_count == modes;
        nyquist_row_.resize(is_owner ? static_cast<std::size_t>(nx) : 0);
        for (const Other& of : ranks) {
            const bool owns = of.ky_count > 0 && of.ky_start + of.ky_count == modes;
            nyquist_to_ranks.push_back(owns ? share.x_count : 0);
            nyquist_from_ranks.push_back(is_owner ? of.x_count : 0);
        }
    }
    sent_.resize(static_cast<std::size_t>(sent));
    received_.resize(static_cast<std::size_t>(received));
    turned_.resize(static_cast<std::size_t>(nx));
}

/// Sends this rank's part of the row at the Nyquist frequency to the rank that transforms it.
void SlabTransform::Work::send_nyquist_row(const Comm& team) {
    if (nyquist_to_ranks.empty()) return;
    const Complex* part = columns() + below_nyquist(ny) * stride;
    team.all_to_all(std::span<const Complex>(part, static_cast<std::size_t>(stride)),
                    nyquist_to_ranks, std::span(nyquist_row_), nyquist_from_ranks);
}

SlabTransform::SlabTransform(std::ptrdiff_t nx, std::ptrdiff_t ny, const Comm& team,
                             Planning planning)
    : work_(std::make_unique<Work>()), planning_(planning), team_(team) {
    fftw_mpi_init();
    const std::ptrdiff_t modes = ny / 2 + 1;
    const std::ptrdiff_t n[2] = {nx, below_nyquist(ny)};
    const std::ptrdiff_t transposed = fftw_mpi_local_size_many_transposed(
        2, n, 1, FFTW_MPI_DEFAULT_BLOCK, FFTW_MPI_DEFAULT_BLOCK, team.raw(), &share_.x_count,
        &share_.x_start, &share_.ky_count, &share_.ky_start);
    if (share_.ky_count > 0 && share_.ky_start + share_.ky_count == n[1])
        share_.ky_count = modes - share_.ky_start;
    const std::ptrdiff_t values =
        std::max({transposed, share_.x_count * modes, share_.ky_count * nx});
    share_.padded_ny = 2 * modes;
    share_.reals = odd_lines(2 * std::max<std::ptrdiff_t>({values, nx, modes}));

    Work& w = *work_;
    w.nx = nx, w.ny = ny, w.modes = modes;
    w.pitch = modes + 3;                  // avoids that lines share their cache sets
    w.line_pitch = odd_lines(2 * nx) / 2; // avoids that lines share their cache sets
    w.lines_.resize(static_cast<std::size_t>(width * w.pitch));
    w.row_.resize(static_cast<std::size_t>(share_.padded_ny));
    w.filled_.resize(static_cast<std::size_t>(nx));
    const bool alone = team.size() == 1;
    w.stride =
        alone ? nx + width : share_.x_count; // FFTW-MPI prescribes the layout on several ranks
    const auto room = static_cast<std::size_t>(
        std::max(share_.reals / 2, alone ? w.stride * modes : std::ptrdiff_t{0}));
    w.columns_.resize(room);
    if (!alone) {
        w.rows_.resize(room);
        w.gather_shares(share_, team);
    }

    AlignedVector<double> plane(static_cast<std::size_t>(share_.reals));
    const auto lines = [&](unsigned flags) { return w.plan_lines(plane.data(), flags); };
    const bool measured = planning == Planning::measured;
    if (measured)
        plan_measured(team, std::to_string(nx) + "x" + std::to_string(ny), lines);
    else
        plan_estimated(lines);
    // A transpose does not change values, so the choice of its plan does not affect the bits.
    if (!alone) w.plan_slabs(team, measured ? FFTW_MEASURE : FFTW_ESTIMATE);
    fftw_forget_wisdom();
}

SlabTransform::~SlabTransform() = default;

void SlabTransform::to_physical(double* plane) const {
    Work& w = *work_;
    auto* modes = reinterpret_cast<Complex*>(plane);
    for (std::ptrdiff_t k = 0; k < share_.ky_count; ++k)
        w.row_to_physical(modes + k * w.nx, k);
    finish_physical(plane);
}

void SlabTransform::to_physical(const FillRow& fill, double* plane) const {
    Work& w = *work_;
    for (std::ptrdiff_t k = 0; k < share_.ky_count; ++k) {
        fill(k, w.filled_.data());
        w.row_to_physical(w.filled_.data(), k);
    }
    finish_physical(plane);
}

/// Transforms along x and copies row k to the send buffer, or to `columns_` for data of this rank.
void SlabTransform::Work::row_to_physical(Complex* row, std::ptrdiff_t k) {
    if (alone()) {
        fftw_execute_dft(x_to_physical.get(), raw(row), raw(columns() + k * stride));
        return;
    }
    fftw_execute_dft(x_to_physical.get(), raw(row), raw(turned_.data()));
    Complex* parcel = sent_.data();
    for (std::size_t rank = 0; rank < ranks.size(); ++rank) {
        const Other& to = ranks[rank];
        std::copy_n(turned_.data() + to.x_start, to.x_count,
                    (rank == me ? columns() : parcel) + k * to.x_count);
        parcel += to_ranks[rank];
    }
}

/// Gathers all ky of `count` rows of this rank, starting at row i, in `lines_`.
void SlabTransform::Work::gather_lines(std::ptrdiff_t i, std::ptrdiff_t count) {
    if (alone()) return columns_to_rows(columns() + i, stride, count, modes, line(0), pitch);
    const Complex* parcel = received_.data();
    for (std::size_t rank = 0; rank < ranks.size(); ++rank) {
        const Other& from = ranks[rank];
        columns_to_rows((rank == me ? columns() : parcel) + i, stride, count, from.ky_count,
                        line(0) + from.ky_start, pitch);
        parcel += from_ranks[rank];
    }
}

/// The steps of to_physical that follow the transforms along x.
void SlabTransform::finish_physical(double* plane) const {
    Work& w = *work_;
    if (!w.alone())
        team_.all_to_all(std::span<const Complex>(w.sent_), w.to_ranks, std::span(w.received_),
                         w.from_ranks);
    for (std::ptrdiff_t i = 0; i < share_.x_count; i += width) {
        const std::ptrdiff_t count = std::min(width, share_.x_count - i);
        w.gather_lines(i, count);
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
    if (w.slabs_to_spectral) {
        w.send_nyquist_row(team_);
        team_.before_collective();
        fftw_execute(w.slabs_to_spectral.get());
    }
    for (std::ptrdiff_t k = 0; k < share_.ky_count; ++k) {
        const bool is_nyquist = !w.nyquist_row_.empty() && k == share_.ky_count - 1;
        Complex* row = is_nyquist ? w.nyquist_row_.data() : w.rows() + k * line_of_x;
        fftw_execute_dft(w.x_to_spectral.get(), raw(row), raw(modes + k * w.nx));
    }
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

} // namespace shearwake::fft
