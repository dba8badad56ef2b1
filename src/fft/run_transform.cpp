#include "fft/run_transform.hpp"

#include "fft/slab_work.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake {
namespace {

/// Where each rank's part begins in a buffer, and the whole.
std::vector<std::ptrdiff_t> starts_of(const std::vector<int>& counts) {
    std::vector<std::ptrdiff_t> starts = {0};
    for (const int count : counts)
        starts.push_back(starts.back() + count);
    return starts;
}

Complex* room_for(AlignedVector<Complex>& buffer, std::ptrdiff_t size) {
    if (std::ssize(buffer) < size) buffer.resize(static_cast<std::size_t>(size));
    return buffer.data();
}

} // namespace

RunTransform::RunTransform(const SlabTransform& slabs, const Comm& team, std::vector<RowRun> runs)
    : RunTransform(slabs, team, std::move(runs), {slabs.share().ky_start, slabs.share().ky_count}) {
}

RunTransform::RunTransform(const SlabTransform& slabs, const Comm& team, std::vector<RowRun> runs,
                           Lines lines)
    : slabs_(slabs), team_(team), runs_(std::move(runs)),
      begin_(runs_.empty() ? 0 : runs_.front().row), end_(runs_.empty() ? 0 : runs_.back().row + 1),
      mine_(lines), lines_reals_(slabs.lines_reals(lines.ky_count)) {
    const SlabShare& share = slabs.share();
    const double mine[4] = {
        static_cast<double>(share.x_start + begin_), static_cast<double>(share.x_start + end_),
        static_cast<double>(lines.ky_start), static_cast<double>(lines.ky_count)};
    const std::vector<double> all = team.all_gather(std::span<const double>(mine));
    for (std::size_t at = 0; at < all.size(); at += 4)
        shares_.push_back({std::lround(all[at]), std::lround(all[at + 1]), std::lround(all[at + 2]),
                           std::lround(all[at + 3])});
}

void RunTransform::transform_row(std::ptrdiff_t row, std::vector<RowRun>::const_iterator& run,
                                 const double* values, Complex* modes) const {
    SlabTransform::Work& w = *slabs_.work_;
    std::fill(w.row_.begin(), w.row_.end(), 0.0);
    for (; run != runs_.end() && run->row == row; ++run)
        std::copy_n(values + run->offset, run->end - run->begin, w.row_.data() + run->begin);
    fftw_execute_dft_r2c(w.y_to_spectral.get(), w.row_.data(), raw(modes));
}

void RunTransform::untransform_row(std::ptrdiff_t row, std::vector<RowRun>::const_iterator& run,
                                   Complex* modes, double* values) const {
    if (run == runs_.end() || run->row != row) return;
    SlabTransform::Work& w = *slabs_.work_;
    fftw_execute_dft_c2r(w.y_to_physical.get(), raw(modes), w.row_.data());
    for (; run != runs_.end() && run->row == row; ++run)
        std::copy_n(w.row_.data() + run->begin, run->end - run->begin, values + run->offset);
}

void RunTransform::to_lines_alone(const double* values, double* lines) const {
    SlabTransform::Work& w = *slabs_.work_;
    auto* columns = reinterpret_cast<Complex*>(lines);
    for (std::ptrdiff_t k = 0; k < w.modes; ++k) {
        std::fill_n(columns + k * w.line_pitch, begin_, 0.0);
        std::fill(columns + k * w.line_pitch + end_, columns + k * w.line_pitch + w.nx, 0.0);
    }
    auto run = runs_.begin();
    for (std::ptrdiff_t i = begin_; i < end_; i += width) {
        const std::ptrdiff_t count = std::min(width, end_ - i);
        for (std::ptrdiff_t r = 0; r < count; ++r)
            transform_row(i + r, run, values, w.line(r));
        rows_to_columns(w.line(0), w.pitch, count, w.modes, columns + i, w.line_pitch);
    }
}

void RunTransform::to_values_alone(const double* lines, double* values) const {
    SlabTransform::Work& w = *slabs_.work_;
    const auto* columns = reinterpret_cast<const Complex*>(lines);
    auto run = runs_.begin();
    for (std::ptrdiff_t i = begin_; i < end_; i += width) {
        const std::ptrdiff_t count = std::min(width, end_ - i);
        columns_to_rows(columns + i, w.line_pitch, count, w.modes, w.line(0), w.pitch);
        for (std::ptrdiff_t r = 0; r < count; ++r)
            untransform_row(i + r, run, w.line(r), values);
    }
}

// Between two ranks go [plane][ky of the one][row of the other].
void RunTransform::to_lines(const double* values, std::size_t cells, std::ptrdiff_t planes,
                            double* lines) const {
    SlabTransform::Work& w = *slabs_.work_;
    const std::ptrdiff_t rows = end_ - begin_, stride = lines_reals_;
    if (w.alone()) {
        for (std::ptrdiff_t p = 0; p < planes; ++p)
            to_lines_alone(values + static_cast<std::size_t>(p) * cells, lines + p * stride);
        return;
    }
    const std::ptrdiff_t ky_count = mine_.ky_count;
    std::vector<int> out, in;
    for (const Share& of : shares_) {
        out.push_back(static_cast<int>(planes * of.ky_count * rows));
        in.push_back(static_cast<int>(planes * ky_count * of.rows()));
    }
    const auto out_at = starts_of(out), in_at = starts_of(in);
    Complex* sent = room_for(w.sent_, out_at.back());
    Complex* received = room_for(w.received_, in_at.back());
    for (std::ptrdiff_t p = 0; p < planes; ++p) {
        const double* of_plane = values + static_cast<std::size_t>(p) * cells;
        auto run = runs_.begin();
        for (std::ptrdiff_t i = begin_; i < end_; i += width) {
            const std::ptrdiff_t count = std::min(width, end_ - i);
            for (std::ptrdiff_t r = 0; r < count; ++r)
                transform_row(i + r, run, of_plane, w.line(r));
            for (std::size_t rank = 0; rank < shares_.size(); ++rank)
                rows_to_columns(
                    w.line(0) + shares_[rank].ky_start, w.pitch, count, shares_[rank].ky_count,
                    sent + out_at[rank] + p * shares_[rank].ky_count * rows + i - begin_, rows);
        }
    }
    team_.all_to_all(sent, out, received, in);
    for (std::ptrdiff_t p = 0; p < planes; ++p) {
        for (std::ptrdiff_t k = 0; k < ky_count; ++k) {
            Complex* line = reinterpret_cast<Complex*>(lines + p * stride) + k * w.line_pitch;
            std::fill_n(line, w.nx, 0.0);
            for (std::size_t rank = 0; rank < shares_.size(); ++rank)
                std::copy_n(received + in_at[rank] + (p * ky_count + k) * shares_[rank].rows(),
                            shares_[rank].rows(), line + shares_[rank].x_begin);
        }
    }
}

void RunTransform::to_values(const double* lines, std::ptrdiff_t planes, double* values,
                             std::size_t cells) const {
    SlabTransform::Work& w = *slabs_.work_;
    const std::ptrdiff_t rows = end_ - begin_, stride = lines_reals_;
    if (w.alone()) {
        for (std::ptrdiff_t p = 0; p < planes; ++p)
            to_values_alone(lines + p * stride, values + static_cast<std::size_t>(p) * cells);
        return;
    }
    const std::ptrdiff_t ky_count = mine_.ky_count;
    std::vector<int> out, in;
    for (const Share& of : shares_) {
        out.push_back(static_cast<int>(planes * ky_count * of.rows()));
        in.push_back(static_cast<int>(planes * of.ky_count * rows));
    }
    const auto out_at = starts_of(out), in_at = starts_of(in);
    Complex* sent = room_for(w.sent_, out_at.back());
    Complex* received = room_for(w.received_, in_at.back());
    for (std::ptrdiff_t p = 0; p < planes; ++p) {
        for (std::ptrdiff_t k = 0; k < ky_count; ++k) {
            const auto* line =
                reinterpret_cast<const Complex*>(lines + p * stride) + k * w.line_pitch;
            for (std::size_t rank = 0; rank < shares_.size(); ++rank)
                std::copy_n(line + shares_[rank].x_begin, shares_[rank].rows(),
                            sent + out_at[rank] + (p * ky_count + k) * shares_[rank].rows());
        }
    }
    team_.all_to_all(sent, out, received, in);
    for (std::ptrdiff_t p = 0; p < planes; ++p) {
        double* of_plane = values + static_cast<std::size_t>(p) * cells;
        auto run = runs_.begin();
        for (std::ptrdiff_t i = begin_; i < end_; i += width) {
            const std::ptrdiff_t count = std::min(width, end_ - i);
            for (std::size_t rank = 0; rank < shares_.size(); ++rank)
                columns_to_rows(
                    received + in_at[rank] + p * shares_[rank].ky_count * rows + i - begin_, rows,
                    count, shares_[rank].ky_count, w.line(0) + shares_[rank].ky_start, w.pitch);
            for (std::ptrdiff_t r = 0; r < count; ++r)
                untransform_row(i + r, run, w.line(r), of_plane);
        }
    }
}

} // namespace shearwake
