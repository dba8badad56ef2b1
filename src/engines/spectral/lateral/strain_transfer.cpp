// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/strain_transfer.hpp"

#include "simd/kernels.hpp"

#include <iterator>

namespace shearwake::spectral {

StrainTransfer::StrainTransfer(const DepthMesh& mesh, std::vector<StrainPoint> points,
                               int components)
    : kernels_(simd::kernels<TransferKernels>()), derivative_(mesh.rule.derivative),
      points_(std::move(points)), components_(components), nodes_(mesh.degree + 1),
      levels_(static_cast<std::ptrdiff_t>(mesh.levels() - 1)) {
    for (const StrainPoint& point : points_)
        places_.push_back({.first = static_cast<std::ptrdiff_t>(point.element) * (nodes_ - 1),
                           .node = point.node,
                           .slope = 2.0 / mesh.length_m(point.element)});
}

TransferArrays StrainTransfer::arrays() const {
    return {.nodes = nodes_,
            .levels = levels_,
            .points = std::ssize(places_),
            .point = places_.data(),
            .derivative = derivative_.data(),
            .components = components_};
}

void StrainTransfer::strain(const WaveBlock& waves, const Block* pencil, double* line,
                            std::ptrdiff_t stride) const {
    kernels_.strain(arrays(), waves, pencil, line, stride);
}

void StrainTransfer::add_force(const WaveBlock& waves, const double* line, std::ptrdiff_t stride,
                               double scale, Block* pencil) const {
    kernels_.add_force(arrays(), waves, line, stride, scale, pencil);
}

} // namespace shearwake::spectral
