// SPDX-License-Identifier: BSD-3-Clause
#include "fft/run_transform.hpp"

#include "base/units.hpp"
#include "fft/slab_work.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <type_traits>

namespace shearwake::fft {

// As for windows of x: the longest for which sums are not slower with vectors of four numbers.
bool RowWindow::pays(std::ptrdiff_t ny, std::ptrdiff_t count) {
    return count > 0 && count < ny &&
           static_cast<double>(count) <= 8.0 * std::log2(static_cast<double>(ny));
}

RowWindow::RowWindow(std::ptrdiff_t ny, std::ptrdiff_t begin, std::ptrdiff_t count)
    : kernels_(simd::kernels<RowWindowKernels>()), begin_(begin), count_(count),
      mode_count_(ny / 2 + 1) {
    const std::ptrdiff_t distances = count / 2 + 1;
    const auto put = [&](AlignedVector<double>& to, std::ptrdiff_t ky, std::ptrdiff_t y) {
        // Reduced to one turn, so that the angle is exact for long rows.
        const double angle = two_pi * static_cast<double>(ky * y % ny) / static_cast<double>(ny);
        to.push_back(std::cos(angle));
        to.push_back(std::sin(angle));
    };
    for (std::ptrdiff_t ky = 0; ky < mode_count_; ++ky) {
        put(middle_, ky, begin + count / 2);
        weights_.push_back(ky == 0 || 2 * ky == ny ? 1.0 : 2.0);
        for (std::ptrdiff_t d = 0; d < distances; ++d)
            put(angles_, ky, d);
    }
    rows_.assign(static_cast<std::size_t>(count * window_rows), 0.0);
    modes_.assign(static_cast<std::size_t>(mode_count_ * window_rows), 0.0);
    scratch_.assign(static_cast<std::size_t>(2 * window_rows * std::max(distances, mode_count_)),
                    0.0);
}

RowWindowArrays RowWindow::arrays() const {
    return {.count = count_,
            .reach = count_ / 2,
            .modes = mode_count_,
            .angles = angles_.data(),
            .middle = middle_.data(),
            .weights = weights_.data()};
}

void RowWindow::clear_rows() {
    std::fill(rows_.begin(), rows_.end(), 0.0);
}

void RowWindow::to_modes() {
    kernels_.to_modes(arrays(), rows_.data(), reals(modes_.data()), scratch_.data());
}

void RowWindow::to_rows() {
    kernels_.to_rows(arrays(), reals(modes_.data()), rows_.data(), scratch_.data());
}

namespace {

/// Offset of each rank's part in a buffer, followed by the total size.
std::vector<std::ptrdiff_t> starts_of(const std::vector<std::ptrdiff_t>& counts) {
    std::vector<std::ptrdiff_t> starts = {0};
    for (const std::ptrdiff_t count : counts)
        starts.push_back(starts.back() + count);
    return starts;
}

std::span<Complex> room_for(AlignedVector<Complex>& buffer, std::ptrdiff_t size) {
    const auto needed = static_cast<std::size_t>(size);
    if (buffer.size() < needed) buffer.resize(needed);
    return {buffer.data(), needed};
}

} // namespace

RunTransform::RunTransform(const SlabTransform& slabs, const Comm& team, std::vector<RowRun> runs)
    : RunTransform(slabs, team, std::move(runs),
                   Lines{slabs.share().ky_start, slabs.share().ky_count}) {}

RunTransform::RunTransform(const SlabTransform& slabs, const Comm& team, std::vector<RowRun> runs,
                           Lines lines)
    : RunTransform(slabs, team, std::move(runs),
                   Layout{lines, slabs.share().x_start, slabs.nx(), slabs.line_pitch(),
                          slabs.lines_reals(lines.ky_count)}) {}

RunTransform::RunTransform(const SlabTransform& slabs, const Comm& team, std::vector<RowRun> runs,
                           const Layout& layout)
    : RunTransform(slabs, team, std::vector<std::vector<RowRun>>{std::move(runs)}, layout) {}

RunTransform::RunTransform(const SlabTransform& slabs, const Comm& team,
                           std::vector<std::vector<RowRun>> run_sets, const Layout& layout)
    : slabs_(slabs), team_(team), run_sets_(std::move(run_sets)), layout_(layout),
      me_(static_cast<std::size_t>(team.rank())) {
    gather_shares();
    long first = slabs.ny(), last = 0; // range of y with runs
    for (const std::vector<RowRun>& runs : run_sets_)
        for (const RowRun& run : runs) {
            first = std::min<long>(first, run.begin);
            last = std::max<long>(last, run.end);
        }
    // The same on all ranks, so that their number does not affect the result.
    const std::vector<long> all = team.all_gather(std::vector<long>{first, last});
    for (std::size_t at = 0; at < all.size(); at += 2) {
        first = std::min(first, all[at]);
        last = std::max(last, all[at + 1]);
    }
    if (RowWindow::pays(slabs.ny(), last - first))
        window_ = std::make_unique<RowWindow>(slabs.ny(), first, last - first);
}

void RunTransform::gather_shares() {
    std::vector<long> mine = {layout_.lines.ky_start, layout_.lines.ky_count};
    for (const std::vector<RowRun>& runs : run_sets_) {
        mine.push_back(runs.empty() ? 0 : layout_.x_start + runs.front().row);
        mine.push_back(runs.empty() ? 0 : layout_.x_start + runs.back().row + 1);
    }
    const std::vector<long> all = team_.all_gather(mine);
    for (auto of = all.begin(); of != all.end(); of += std::ssize(mine)) {
        Share share{.lines = {of[0], of[1]}, .rows = {}};
        for (std::ptrdiff_t at = 2; at < std::ssize(mine); at += 2)
            share.rows.push_back({of[at], of[at + 1]});
        shares_.push_back(std::move(share));
    }
}

RunTransform::Rows RunTransform::rows_at(std::ptrdiff_t i, const Range& of) const {
    return {i, std::min(window_ ? window_rows : width, of.end - layout_.x_start - i)};
}

/// Transforms rows to their modes, in the buffer of modes_of().
void RunTransform::transform(Rows rows, RemainingRuns& runs, const double* values) const {
    if (!window_) {
        for (std::ptrdiff_t r = 0; r < rows.count; ++r)
            transform_row(rows.first + r, runs, values, slabs_.work_->line(r));
        return;
    }
    window_->clear_rows();
    for (; !runs.empty() && runs.front().row < rows.first + rows.count; runs = runs.subspan(1)) {
        const RowRun& run = runs.front();
        double* to = window_->point(run.begin) + run.row - rows.first;
        for (std::ptrdiff_t j = 0; j < run.end - run.begin; ++j)
            to[j * window_rows] = values[run.offset + static_cast<std::size_t>(j)];
    }
    window_->to_modes();
}

void RunTransform::untransform(Rows rows, RemainingRuns& runs, double* values) const {
    if (!window_) {
        for (std::ptrdiff_t r = 0; r < rows.count; ++r)
            untransform_row(rows.first + r, runs, slabs_.work_->line(r), values);
        return;
    }
    window_->to_rows();
    for (; !runs.empty() && runs.front().row < rows.first + rows.count; runs = runs.subspan(1)) {
        const RowRun& run = runs.front();
        const double* from = window_->point(run.begin) + run.row - rows.first;
        for (std::ptrdiff_t j = 0; j < run.end - run.begin; ++j)
            values[run.offset + static_cast<std::size_t>(j)] = from[j * window_rows];
    }
}

/// Copies the modes of some ky of the transformed rows to columns, and back.
void RunTransform::put_columns(Rows rows, const Lines& to, Complex* columns,
                               std::ptrdiff_t pitch) const {
    SlabTransform::Work& w = *slabs_.work_;
    if (!window_)
        return rows_to_columns(w.line(0) + to.ky_start, w.pitch, rows.count, to.ky_count, columns,
                               pitch);
    with_constant<window_rows>(rows.count, [&](auto count) {
        for (std::ptrdiff_t k = 0; k < to.ky_count; ++k)
            std::copy_n(window_->mode(to.ky_start + k), +count, columns + k * pitch);
    });
}

void RunTransform::gather_columns(Rows rows, const Lines& from, const Complex* columns,
                                  std::ptrdiff_t pitch) const {
    SlabTransform::Work& w = *slabs_.work_;
    if (!window_)
        return columns_to_rows(columns, pitch, rows.count, from.ky_count, w.line(0) + from.ky_start,
                               w.pitch);
    with_constant<window_rows>(rows.count, [&](auto count) {
        for (std::ptrdiff_t k = 0; k < from.ky_count; ++k)
            std::copy_n(columns + k * pitch, +count, window_->mode(from.ky_start + k));
    });
}

void RunTransform::transform_row(std::ptrdiff_t row, RemainingRuns& runs, const double* values,
                                 Complex* modes) const {
    SlabTransform::Work& w = *slabs_.work_;
    if (runs.empty() || runs.front().row != row) {
        std::fill_n(modes, w.modes, 0.0);
        return;
    }
    std::fill(w.row_.begin(), w.row_.end(), 0.0);
    for (; !runs.empty() && runs.front().row == row; runs = runs.subspan(1))
        std::copy_n(values + runs.front().offset, runs.front().end - runs.front().begin,
                    w.row_.data() + runs.front().begin);
    fftw_execute_dft_r2c(w.y_to_spectral.get(), w.row_.data(), raw(modes));
}

void RunTransform::untransform_row(std::ptrdiff_t row, RemainingRuns& runs, Complex* modes,
                                   double* values) const {
    if (runs.empty() || runs.front().row != row) return;
    SlabTransform::Work& w = *slabs_.work_;
    fftw_execute_dft_c2r(w.y_to_physical.get(), raw(modes), w.row_.data());
    for (; !runs.empty() && runs.front().row == row; runs = runs.subspan(1))
        std::copy_n(w.row_.data() + runs.front().begin, runs.front().end - runs.front().begin,
                    values + runs.front().offset);
}

/// Planes of the first sheet whose values are `cells` apart.
std::vector<RunTransform::Plane> RunTransform::equal_planes(std::ptrdiff_t count,
                                                            std::size_t cells) {
    std::vector<Plane> planes;
    for (std::size_t p = 0; p < static_cast<std::size_t>(count); ++p)
        planes.push_back({0, p * cells});
    return planes;
}

void RunTransform::to_lines(const double* values, std::size_t cells, std::ptrdiff_t planes,
                            double* lines) const {
    to_lines(values, equal_planes(planes, cells), lines);
}

void RunTransform::to_values(const double* lines, std::ptrdiff_t planes, double* values,
                             std::size_t cells) const {
    to_values(lines, equal_planes(planes, cells), values);
}

/// Number of rows with runs of some planes together.
std::ptrdiff_t RunTransform::rows_of(std::span<const Plane> planes, const Share& share) const {
    std::ptrdiff_t rows = 0;
    for (const Plane& plane : planes)
        rows += share.rows[plane.sheet].count();
    return rows;
}

template <class Real>
auto* RunTransform::lines_of(Real* lines, std::ptrdiff_t plane) const {
    using Value = std::conditional_t<std::is_const_v<Real>, const Complex, Complex>;
    return lines ? reinterpret_cast<Value*>(lines + plane * layout_.reals) : nullptr;
}

// Data exchanged between two ranks is ordered as [plane][ky of the rank with the lines][row of the
// rank with the rows]. Data that stays on this rank is copied directly.
RunTransform::ExchangeBuffers RunTransform::exchange_buffers(std::span<const Plane> planes) const {
    SlabTransform::Work& w = *slabs_.work_;
    const std::ptrdiff_t rows = rows_of(planes, shares_[me_]);
    ExchangeBuffers p;
    for (std::size_t rank = 0; rank < shares_.size(); ++rank) {
        const Share& of = shares_[rank];
        const bool other = rank != me_;
        p.of_rows.push_back(other ? of.lines.ky_count * rows : 0);
        p.of_lines.push_back(other ? layout_.lines.ky_count * rows_of(planes, of) : 0);
    }
    p.of_rows_at = starts_of(p.of_rows);
    p.of_lines_at = starts_of(p.of_lines);
    p.rows = room_for(w.sent_, p.of_rows_at.back());
    p.lines = room_for(w.received_, p.of_lines_at.back());
    return p;
}

void RunTransform::to_lines(const double* values, std::span<const Plane> planes,
                            double* lines) const {
    ExchangeBuffers buffers = exchange_buffers(planes);
    for (std::ptrdiff_t p = 0; p < std::ssize(planes); ++p) {
        const Plane& plane = planes[static_cast<std::size_t>(p)];
        const Range& mine = shares_[me_].rows[plane.sheet];
        Complex* here = lines_of(lines, p);
        RemainingRuns rest = run_sets_[plane.sheet];
        const std::ptrdiff_t begin = mine.begin - layout_.x_start;
        for (Rows now = rows_at(begin, mine); now.count > 0;
             now = rows_at(now.first + now.count, mine)) {
            transform(now, rest, values + plane.first);
            const std::ptrdiff_t at = now.first - begin;
            for (std::size_t rank = 0; rank < shares_.size(); ++rank) {
                const Lines& to = shares_[rank].lines;
                if (to.ky_count == 0) continue;
                if (rank == me_)
                    put_columns(now, to, here + mine.begin + at, layout_.pitch);
                else
                    put_columns(now, to, buffers.rows.data() + buffers.of_rows_at[rank] + at,
                                mine.count());
            }
        }
        for (std::size_t rank = 0; rank < shares_.size(); ++rank)
            if (rank != me_)
                buffers.of_rows_at[rank] += shares_[rank].lines.ky_count * mine.count();
    }
    if (shares_.size() > 1)
        team_.all_to_all(std::span<const Complex>(buffers.rows), buffers.of_rows, buffers.lines,
                         buffers.of_lines);
    for (std::ptrdiff_t p = 0; p < std::ssize(planes); ++p)
        for (std::ptrdiff_t k = 0; k < layout_.lines.ky_count; ++k)
            fill_line(buffers, planes[static_cast<std::size_t>(p)].sheet,
                      lines_of(lines, p) + k * layout_.pitch);
}

void RunTransform::fill_line(ExchangeBuffers& buffers, std::size_t sheet, Complex* line) const {
    std::ptrdiff_t filled = 0; // index in x; the parts of the ranks are in ascending order
    for (std::size_t rank = 0; rank < shares_.size(); ++rank) {
        const Range& of = shares_[rank].rows[sheet];
        if (of.count() == 0) continue;
        std::fill(line + filled, line + of.begin, 0.0);
        if (rank != me_) {
            std::copy_n(buffers.lines.data() + buffers.of_lines_at[rank], of.count(),
                        line + of.begin);
            buffers.of_lines_at[rank] += of.count();
        }
        filled = of.end;
    }
    std::fill(line + filled, line + layout_.length, 0.0);
}

void RunTransform::to_values(const double* lines, std::span<const Plane> planes,
                             double* values) const {
    ExchangeBuffers buffers = exchange_buffers(planes);
    for (std::ptrdiff_t p = 0; p < std::ssize(planes); ++p)
        for (std::ptrdiff_t k = 0; k < layout_.lines.ky_count; ++k)
            for (std::size_t rank = 0; rank < shares_.size(); ++rank) {
                const Range& of = shares_[rank].rows[planes[static_cast<std::size_t>(p)].sheet];
                if (rank == me_ || of.count() == 0) continue;
                std::copy_n(lines_of(lines, p) + k * layout_.pitch + of.begin, of.count(),
                            buffers.lines.data() + buffers.of_lines_at[rank]);
                buffers.of_lines_at[rank] += of.count();
            }
    if (shares_.size() > 1)
        team_.all_to_all(std::span<const Complex>(buffers.lines), buffers.of_lines, buffers.rows,
                         buffers.of_rows);
    for (std::ptrdiff_t p = 0; p < std::ssize(planes); ++p) {
        const Plane& plane = planes[static_cast<std::size_t>(p)];
        const Range& mine = shares_[me_].rows[plane.sheet];
        RemainingRuns rest = run_sets_[plane.sheet];
        const std::ptrdiff_t begin = mine.begin - layout_.x_start;
        for (Rows now = rows_at(begin, mine); now.count > 0;
             now = rows_at(now.first + now.count, mine)) {
            const std::ptrdiff_t at = now.first - begin;
            for (std::size_t rank = 0; rank < shares_.size(); ++rank) {
                const Lines& from = shares_[rank].lines;
                if (from.ky_count == 0) continue;
                if (rank == me_)
                    gather_columns(now, from, lines_of(lines, p) + mine.begin + at, layout_.pitch);
                else
                    gather_columns(now, from, buffers.rows.data() + buffers.of_rows_at[rank] + at,
                                   mine.count());
            }
            untransform(now, rest, values + plane.first);
        }
        for (std::size_t rank = 0; rank < shares_.size(); ++rank)
            if (rank != me_)
                buffers.of_rows_at[rank] += shares_[rank].lines.ky_count * mine.count();
    }
}

} // namespace shearwake::fft
