// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/strain_planes.hpp"

#include "engines/spectral/depth/work_kinds.hpp"

#include <algorithm>

namespace shearwake::spectral {

using namespace kinds;

StrainPlanes::StrainPlanes(const LateralField& field, const fft::SlabTransform& slabs,
                           const Comm& team, StepClock& clock)
    : field_(field), slabs_(slabs), clock_(clock), nx_(slabs.nx()),
      count_(static_cast<std::ptrdiff_t>(field.points()) * field.variation().components()) {
    for (const LateralVariation::Point& point : field.variation().points)
        runs_.emplace_back(slabs, team, point.runs);
}

void StrainPlanes::assemble() {
    planes_.assign(static_cast<std::size_t>(count_ * stride()), 0.0);
}

void StrainPlanes::set(const LateralField::Values& values) {
    const engines::Timed timed(of_transfer);
    double* plane = planes_.data();
    const int components = field_.variation().components();
    for (std::size_t p = 0; p < field_.points(); ++p) {
        runs_[p].to_lines(values.data() + field_.range(p).first, field_.variation().points[p].cells,
                          components, plane);
        plane += components * stride();
    }
    transforms_ += count_;
    clock_.lap(Phase::transforms, 2.0 * memory_B());
}

void StrainPlanes::get(LateralField::Values& values) {
    const engines::Timed timed(of_transfer);
    const double* plane = planes_.data();
    const int components = field_.variation().components();
    for (std::size_t p = 0; p < field_.points(); ++p) {
        runs_[p].to_values(plane, components, values.data() + field_.range(p).first,
                           field_.variation().points[p].cells);
        plane += components * stride();
    }
    transforms_ += count_;
    clock_.lap(Phase::transforms, 2.0 * memory_B());
}

void StrainPlanes::begin_row(std::ptrdiff_t row) {
    const engines::Timed timed(of_transfer);
    for (std::ptrdiff_t p = 0; p < count_; ++p)
        slabs_.line_to_spectral(line(row) + p * stride());
    clock_.lap(Phase::transforms);
}

void StrainPlanes::end_row(std::ptrdiff_t row, Modes kept) {
    const engines::Timed timed(of_transfer);
    for (std::ptrdiff_t p = 0; p < count_; ++p) {
        double* modes = line(row) + p * stride();
        if (kept == Modes::emptied) {
            std::fill_n(modes, 2 * nx_, 0.0);
            continue;
        }
        modes[nx_] = modes[nx_ + 1] = 0.0; // kx = nx/2
        slabs_.line_to_physical(modes);
    }
    clock_.lap(Phase::transforms);
}

} // namespace shearwake::spectral
