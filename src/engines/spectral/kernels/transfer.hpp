// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/lines.hpp"

namespace shearwake::spectral {

/// Components of a strain or stress plane, with engineering shear strains (2 eps). If the density
/// varies, the displacement follows.
enum Component {
    xx,
    yy,
    zz,
    yz,
    xz,
    xy,
    strain_components,
    ux = strain_components,
    uy,
    uz,
    all_components
};

/// A node of an element at which strain is computed.
struct TransferPoint {
    std::ptrdiff_t first; // first level of the element
    std::ptrdiff_t node;
    double slope; // 2 / (length of the element)
};

/// The data of StrainTransfer as arrays.
struct TransferArrays {
    std::ptrdiff_t nodes, levels; // nodes per element; moving levels
    std::ptrdiff_t points;
    const TransferPoint* point;
    const double* derivative; // of the reference element: [node][node]
    int components;
};

/// The operations of engines/spectral/lateral/strain_transfer.hpp; `stride` is the number of
/// doubles between the lines of consecutive planes.
struct TransferKernels {
    void (*strain)(const TransferArrays& arrays, const WaveBlock& waves, const Block* pencil,
                   double* line, std::ptrdiff_t stride);
    void (*add_force)(const TransferArrays& arrays, const WaveBlock& waves, const double* line,
                      std::ptrdiff_t stride, double scale, Block* pencil);
};

} // namespace shearwake::spectral
