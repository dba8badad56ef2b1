// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/displacement_planes.hpp"

#include "simd/kernels.hpp"

namespace shearwake::spectral {

DisplacementPlanes::DisplacementPlanes(std::vector<DepthWeights> depths, Runs runs,
                                       const DepthMesh& mesh, const WaveVectors& vectors,
                                       const fft::SlabTransform& slabs, const Comm& team)
    : kernels_(simd::kernels<DisplacementKernels>()), vectors_(vectors), nodes_(mesh.degree + 1),
      levels_(static_cast<std::ptrdiff_t>(mesh.levels()) - 1), depths_(std::move(depths)) {
    std::size_t first = 0;
    for (std::size_t d = 0; d < depths_.size(); ++d) {
        places_.push_back({depths_[d].first, depths_[d].weights.data()});
        std::size_t cells = 0;
        for (const fft::RowRun& run : runs[d])
            cells += static_cast<std::size_t>(run.end - run.begin);
        points_.push_back({.runs = std::move(runs[d]), .first = first, .cells = cells});
        first += cells;
    }
    planes_.emplace(
        PlaneCells{.points = points_, .components = components, .x_start = slabs.share().x_start},
        slabs, team, StrainPlanes::Corner{});
    planes_->assemble();
    // Two lines of zeros, one of ones, and two of zeros.
    unit_.assign(static_cast<std::size_t>(10 * vectors.nx()), 0.0);
    for (std::ptrdiff_t i = 0; i < vectors.nx(); ++i)
        unit_[static_cast<std::size_t>(4 * vectors.nx() + 2 * i)] = 1.0;
}

std::size_t DisplacementPlanes::size() const {
    return points_.empty() ? 0 : (points_.back().first + points_.back().cells) * components;
}

DisplacementArrays DisplacementPlanes::arrays() const {
    return {
        .nodes = nodes_, .levels = levels_, .depths = std::ssize(places_), .depth = places_.data()};
}

void DisplacementPlanes::evaluate(std::ptrdiff_t row, std::ptrdiff_t block, const Block* pencil) {
    kernels_.displacement(arrays(), planes_->in_line(vectors_.waves(row, block)), pencil,
                          planes_->line(row), planes_->stride());
}

void DisplacementPlanes::end_row(std::ptrdiff_t row, std::size_t from) {
    if (vectors_.is_nyquist(row))
        planes_->end_row(row, StrainPlanes::Modes::emptied);
    else
        planes_->end_row_from(row, static_cast<std::ptrdiff_t>(from * components));
}

void DisplacementPlanes::add_force(std::ptrdiff_t row, std::ptrdiff_t block, double scale,
                                   Block* pencil) {
    kernels_.add_force(arrays(), planes_->in_line(vectors_.waves(row, block)), planes_->line(row),
                       planes_->stride(), scale, pencil);
}

void DisplacementPlanes::add_unit(std::ptrdiff_t row, std::ptrdiff_t block, std::size_t depth,
                                  std::size_t component, double scale, Block* pencil) const {
    const DisplacementArrays one = {
        .nodes = nodes_, .levels = levels_, .depths = 1, .depth = &places_[depth]};
    // The line of ones is the one of this component.
    const std::ptrdiff_t stride = 2 * vectors_.nx();
    const double* lines = unit_.data() + (2 - static_cast<std::ptrdiff_t>(component)) * stride;
    kernels_.add_force(one, vectors_.waves(row, block), lines, stride, scale, pencil);
}

} // namespace shearwake::spectral
