// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/spectral/kernels/transfer.hpp"
#include "engines/spectral/lateral/moving_load.hpp"

#include <vector>

namespace shearwake::spectral {

/// A node of an element at which strain is computed. Adjacent elements have separate points at
/// their common node.
struct StrainPoint {
    std::size_t element = 0;
    std::ptrdiff_t node = 0;
};

/// Transfers between pencils over depth and planes of strain at the chosen points, given as lines
/// of their spectra, [point][component]. With u_x = i (c U - s V), u_y = i (s U + c V), c = kx/k, s
/// = ky/k. Not collective.
class StrainTransfer {
public:
    StrainTransfer(const DepthMesh& mesh, std::vector<StrainPoint> points, int components);

    std::ptrdiff_t planes() const {
        return static_cast<std::ptrdiff_t>(points_.size()) * components_;
    }
    int components() const { return components_; }
    const std::vector<StrainPoint>& points() const { return points_; }

    /// Writes the strain of a pencil to the lines of its ky. `line` is that of the first plane;
    /// `stride` is the number of doubles between planes.
    void strain(const WaveBlock& waves, const Block* pencil, double* line,
                std::ptrdiff_t stride) const;
    /// Adds `scale` times the negative forces that the stresses in these lines (times their
    /// quadrature weights) exert to a pencil.
    void add_force(const WaveBlock& waves, const double* line, std::ptrdiff_t stride, double scale,
                   Block* pencil) const;

private:
    TransferArrays arrays() const;

    const TransferKernels& kernels_;
    std::vector<double> derivative_; // of the reference element
    std::vector<StrainPoint> points_;
    std::vector<TransferPoint> places_; // one per point
    int components_;
    std::ptrdiff_t nodes_, levels_;
};

} // namespace shearwake::spectral
