// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/strain_planes.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace shearwake::spectral {

namespace {

/// Size of the data of all ranks that are exchanged together. Fewer messages reduce the latency;
/// the buffers remain small.
constexpr double exchanged_B = 8e6;

} // namespace

StrainPlanes::StrainPlanes(const PlaneCells& cells, const fft::SlabTransform& slabs,
                           const Comm& team, StepClock& clock, Corner corner)
    : cells_(cells), slabs_(slabs), clock_(clock), nx_(slabs.nx()),
      count_(static_cast<std::ptrdiff_t>(cells.points.size() * cells.components)) {
    const CellExtent extent = cells.extent(&team);
    if (LineWindow::pays(nx_, extent.x_end - extent.x_begin))
        window_.emplace(nx_, extent.x_begin - corner.x, extent.x_end - extent.x_begin);
    const fft::SlabShare& share = slabs.share();
    const std::ptrdiff_t left = window_ ? extent.x_begin : corner.x;
    const fft::RunTransform::Layout layout{{share.ky_start, share.ky_count},
                                           cells.x_start - left,
                                           window_ ? window_->count() : nx_,
                                           window_ ? window_->count() : slabs.line_pitch(),
                                           stored_stride()};
    const std::size_t components = cells.components, points = cells.points.size();
    const double of_point_B = static_cast<double>(components) * sizeof(std::complex<double>) *
                              static_cast<double>(extent.x_end - extent.x_begin) *
                              static_cast<double>(slabs.ny() / 2 + 1);
    const auto together =
        static_cast<std::size_t>(points_together(static_cast<double>(points), of_point_B));
    for (std::size_t first = 0; first < points; first += together) {
        const std::size_t end = std::min(first + together, points);
        std::vector<std::vector<fft::RowRun>> sheets;
        std::vector<fft::RunTransform::Plane> planes;
        for (std::size_t p = first; p < end; ++p) {
            const PlaneCells::Point& point = cells.points[p];
            sheets.push_back(point.runs);
            for (fft::RowRun& run : sheets.back()) {
                run.begin -= corner.y;
                run.end -= corner.y;
            }
            for (std::size_t c = 0; c < components; ++c)
                planes.push_back({p - first, cells.range(p).first + c * point.cells});
        }
        groups_.push_back({first, end, fft::RunTransform(slabs, team, std::move(sheets), layout),
                           std::move(planes)});
    }
}

double StrainPlanes::points_together(double points, double of_point_B) {
    return std::max(1.0, std::min(points, std::floor(exchanged_B / (of_point_B + 1.0))));
}

std::ptrdiff_t StrainPlanes::stored_stride() const {
    return window_ ? 2 * slabs_.share().ky_count * window_->count() : slabs_.lines_reals();
}

void StrainPlanes::assemble() {
    planes_.assign(static_cast<std::size_t>(count_ * stored_stride()), 0.0);
    if (window_) spectra_.assign(static_cast<std::size_t>(count_ * stride()), 0.0);
}

void StrainPlanes::set(const Values& values) {
    for (const Group& group : groups_)
        group.transform.to_lines(values.data(), group.planes, stored_plane(group.first_point));
    transforms_ += count_;
    clock_.lap(Phase::transforms, 2.0 * memory_B());
}

void StrainPlanes::get(Values& values) {
    get_from(0, values);
}

void StrainPlanes::get_from(std::size_t first, Values& values) {
    for (const Group& group : groups_)
        if (group.end_point > first)
            group.transform.to_values(stored_plane(group.first_point), group.planes, values.data());
    transforms_ += count_;
    clock_.lap(Phase::transforms, 2.0 * memory_B());
}

void StrainPlanes::begin_row(std::ptrdiff_t row) {
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
