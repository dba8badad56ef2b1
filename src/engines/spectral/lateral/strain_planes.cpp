// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/strain_planes.hpp"

#include "base/units.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace shearwake::spectral {

namespace {

std::ptrdiff_t blocks_of(std::ptrdiff_t count) {
    return (count + lane_count - 1) / lane_count;
}

} // namespace

// Measured with 256 points: an FFT takes as long as a window of some 100 points with vectors of
// eight numbers and half as many with four.
bool LineWindow::pays(std::ptrdiff_t nx, std::ptrdiff_t count) {
    return count > 0 && static_cast<double>(count) <= 8.0 * std::log2(static_cast<double>(nx));
}

LineWindow::LineWindow(std::ptrdiff_t nx, std::ptrdiff_t begin, std::ptrdiff_t count)
    : kernels_(simd::kernels<WindowKernels>()), nx_(nx), begin_(begin), count_(count) {
    const std::ptrdiff_t half = nx / 2, modes = paired(nx) + 1, distances = count / 2 + 1;
    const auto size = [](std::ptrdiff_t n) { return static_cast<std::size_t>(n); };
    by_distance_.assign(size(blocks_of(distances - 1) * modes), Turn{});
    by_kx_.assign(size(blocks_of(paired(nx)) * distances), Turn{});
    of_middle_.assign(size(blocks_of(half)), Turn{});
    const auto put = [&](Turn& turn, std::ptrdiff_t lane, std::ptrdiff_t k, std::ptrdiff_t x,
                         double weight) {
        // Reduced to one turn, so that the angle is exact for long lines.
        const double angle = two_pi * static_cast<double>(k * x % nx) / static_cast<double>(nx);
        turn.cosine[lane] = weight * std::cos(angle);
        turn.sine[lane] = weight * std::sin(angle);
    };
    for (std::ptrdiff_t k = 0; k < half; ++k)
        put(of_middle_[size(k / lane_count)], k % lane_count, k, begin + count / 2, 1.0);
    for (std::ptrdiff_t d = 1; d < distances; ++d)
        for (std::ptrdiff_t k = 0; k < modes; ++k)
            put(by_distance_[size((d - 1) / lane_count * modes + k)], (d - 1) % lane_count, k, d,
                k == 0 || 2 * k == half ? 0.5 : 1.0);
    for (std::ptrdiff_t k = 0; k < blocks_of(paired(nx)) * lane_count; ++k)
        for (std::ptrdiff_t d = 0; d < distances; ++d)
            put(by_kx_[size(k / lane_count * distances + d)], k % lane_count, k, d, 1.0);
}

WindowArrays LineWindow::arrays() const {
    return {.nx = nx_,
            .count = count_,
            .reach = count_ / 2,
            .by_distance = by_distance_.data(),
            .by_kx = by_kx_.data()};
}

void LineWindow::to_window(std::ptrdiff_t planes, const double* line, std::ptrdiff_t line_stride,
                           double* window, std::ptrdiff_t window_stride) {
    kernels_.to_window(arrays(), planes, line, line_stride, window, window_stride,
                       scratch(2 * folds * (paired(nx_) + 1)));
}

void LineWindow::to_line(std::ptrdiff_t planes, const double* window, std::ptrdiff_t window_stride,
                         double* line, std::ptrdiff_t line_stride) {
    kernels_.to_line(arrays(), planes, window, window_stride, line, line_stride,
                     scratch(planes * folds * (count_ / 2 + 1)));
}

double* LineWindow::scratch(std::ptrdiff_t size) {
    const auto needed = static_cast<std::size_t>(size);
    if (scratch_.size() < needed) scratch_.resize(needed);
    return scratch_.data();
}

namespace {

/// Size of the data of all ranks that are exchanged together. Fewer messages reduce the latency;
/// the buffers remain small.
constexpr double exchanged_B = 8e6;

} // namespace

StrainPlanes::StrainPlanes(const PlaneCells& cells, const fft::SlabTransform& slabs,
                           const Comm& team, Corner corner)
    : cells_(cells), slabs_(slabs), nx_(slabs.nx()),
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
        std::vector<std::vector<fft::RowRun>> run_sets;
        std::vector<fft::RunTransform::Plane> planes;
        for (std::size_t p = first; p < end; ++p) {
            const PlaneCells::Point& point = cells.points[p];
            run_sets.push_back(point.runs);
            for (fft::RowRun& run : run_sets.back()) {
                run.begin -= corner.y;
                run.end -= corner.y;
            }
            for (std::size_t c = 0; c < components; ++c)
                planes.push_back({p - first, cells.range(p).first + c * point.cells});
        }
        groups_.push_back({first, end, fft::RunTransform(slabs, team, std::move(run_sets), layout),
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
}

void StrainPlanes::get(Values& values) {
    get_from(0, values);
}

void StrainPlanes::get_from(std::size_t first, Values& values) {
    for (const Group& group : groups_)
        if (group.end_point > first)
            group.transform.to_values(stored_plane(group.first_point), group.planes, values.data());
    transforms_ += count_;
}

void StrainPlanes::begin_row(std::ptrdiff_t row) {
    if (window_)
        window_->to_line(count_, stored(row), stored_stride(), line(row), stride());
    else
        for (std::ptrdiff_t p = 0; p < count_; ++p)
            slabs_.line_to_spectral(line(row) + p * stride());
}

void StrainPlanes::end_row(std::ptrdiff_t row, Modes modes) {
    if (modes == Modes::retained) return end_row_from(row, 0);
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
}

} // namespace shearwake::spectral
