// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/lines.hpp"

namespace shearwake::spectral {

/// Components of the displacement and the force at a marker of an endless body: along its axis
/// (divided by i), across it, and along z. With this factor all responses are real.
enum MarkerComponent { along, across, down, marker_components };
/// Blocks per marker: the real and the imaginary part of each component.
constexpr std::ptrdiff_t marker_parts = 2 * marker_components;

/// Markers at one depth.
struct MarkerDepth {
    std::ptrdiff_t first;      // first level of the element
    const double* weights;     // of the element's nodes, for the interpolating polynomial
    std::ptrdiff_t begin, end; // range of the markers
};

/// The data of SectionMarkers as arrays.
struct MarkerArrays {
    std::ptrdiff_t nodes, levels; // nodes per element; moving levels
    std::ptrdiff_t depths;
    const MarkerDepth* depth;
    bool along_x; // the axis is parallel to x, otherwise to y
    /// Sum over both signs of the wavenumber across the axis: sign of the real and the imaginary
    /// part of what the wave vectors at -kx contribute, per component.
    double mirrored_re[marker_components], mirrored_im[marker_components];
};

/// Transfers between a pencil and the markers of endless bodies. `phase` holds g cos and g sin of
/// the wavenumber across the axis times the position of each marker, with the smoothing g.
struct MarkerKernels {
    /// Adds the displacement of eight wave vectors to `values`, [marker][marker_parts]. `mirrored`
    /// is 1 where the wave vector at -kx counts and 0 elsewhere.
    void (*evaluate)(const MarkerArrays& arrays, const WaveBlock& waves, const Block& mirrored,
                     const Block* pencil, const Block* phase, Block* values);
    /// Adds `scale` times the forces of the markers to a pencil.
    void (*add_force)(const MarkerArrays& arrays, const WaveBlock& waves, const Block* values,
                      const Block* phase, double scale, Block* pencil);
};

} // namespace shearwake::spectral
