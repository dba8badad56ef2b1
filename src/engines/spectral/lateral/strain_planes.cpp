// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/strain_planes.hpp"

#include "engines/spectral/depth/work_kinds.hpp"

#include <algorithm>

namespace shearwake::spectral {

using namespace kinds;

StrainPlanes::StrainPlanes(const LateralField& field, const fft::SlabTransform& slabs,
                           const Comm& team, StepClock& clock, Corner corner)
    : field_(field), slabs_(slabs), clock_(clock), nx_(slabs.nx()),
      count_(static_cast<std::ptrdiff_t>(field.points()) * field.variation().components()) {
    const CellExtent extent = field.extent(team);
    if (LineWindow::pays(nx_, extent.x_end - extent.x_begin))
        window_.emplace(nx_, extent.x_begin - corner.x, extent.x_end - extent.x_begin);
    const fft::SlabShare& share = slabs.share();
    const std::ptrdiff_t first = window_ ? extent.x_begin : corner.x;
    const fft::RunTransform::Layout layout{{share.ky_start, share.ky_count},
                                           field.x_start() - first,
                                           window_ ? window_->count() : nx_,
                                           window_ ? window_->count() : slabs.line_pitch(),
                                           stored_stride()};
    for (const LateralVariation::Point& point : field.variation().points) {
        std::vector<fft::RowRun> runs = point.runs;
        for (fft::RowRun& run : runs) {
            run.begin -= corner.y;
            run.end -= corner.y;
        }
        runs_.emplace_back(slabs, team, std::move(runs), layout);
    }
}

const engines::WorkKind& StrainPlanes::kind() const {
    return window_ ? of_window : of_transfer;
}

std::ptrdiff_t StrainPlanes::stored_stride() const {
    return window_ ? 2 * slabs_.share().ky_count * window_->count() : slabs_.lines_reals();
}

void StrainPlanes::assemble() {
    planes_.assign(static_cast<std::size_t>(count_ * stored_stride()), 0.0);
    if (window_) spectra_.assign(static_cast<std::size_t>(count_ * stride()), 0.0);
}

void StrainPlanes::set(const LateralField::Values& values) {
    const engines::Timed timed(kind());
    double* plane = planes_.data();
    const int components = field_.variation().components();
    for (std::size_t p = 0; p < field_.points(); ++p) {
        runs_[p].to_lines(values.data() + field_.range(p).first, field_.variation().points[p].cells,
                          components, plane);
        plane += components * stored_stride();
    }
    transforms_ += count_;
    clock_.lap(Phase::transforms, 2.0 * memory_B());
}

void StrainPlanes::get(LateralField::Values& values) {
    get_from(0, values);
}

void StrainPlanes::get_from(std::size_t first, LateralField::Values& values) {
    const engines::Timed timed(kind());
    const int components = field_.variation().components();
    for (std::size_t p = first; p < field_.points(); ++p)
        runs_[p].to_values(
            planes_.data() + static_cast<std::ptrdiff_t>(p) * components * stored_stride(),
            components, values.data() + field_.range(p).first, field_.variation().points[p].cells);
    transforms_ += count_;
    clock_.lap(Phase::transforms, 2.0 * memory_B());
}

void StrainPlanes::begin_row(std::ptrdiff_t row) {
    const engines::Timed timed(kind());
    if (window_)
        window_->to_line(count_, stored(row), stored_stride(), line(row), stride());
    else
        for (std::ptrdiff_t p = 0; p < count_; ++p)
            slabs_.line_to_spectral(line(row) + p * stride());
    clock_.lap(Phase::transforms);
}

void StrainPlanes::end_row(std::ptrdiff_t row, Modes kept) {
    if (kept == Modes::kept) return end_row_from(row, 0);
    const std::ptrdiff_t length = window_ ? window_->count() : nx_;
    for (std::ptrdiff_t p = 0; p < count_; ++p)
        std::fill_n(stored(row) + p * stored_stride(), 2 * length, 0.0);
}

void StrainPlanes::end_row_from(std::ptrdiff_t row, std::ptrdiff_t first) {
    const engines::Timed timed(kind());
    if (window_) {
        window_->to_window(count_ - first, line(row) + first * stride(), stride(),
                           stored(row) + first * stored_stride(), stored_stride());
    } else {
        for (std::ptrdiff_t p = first; p < count_; ++p) {
            double* modes = line(row) + p * stride();
            modes[nx_] = modes[nx_ + 1] = 0.0; // kx = nx/2
            slabs_.line_to_physical(modes);
        }
    }
    clock_.lap(Phase::transforms);
}

} // namespace shearwake::spectral
