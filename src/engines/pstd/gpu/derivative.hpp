// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/gpu/device.hpp"
#include "engines/pstd/scheme/grid.hpp"
#include "fft/staggered_derivative.hpp"

namespace shearwake::pstd::gpu {

/// Spectral derivatives along an axis, as fft::StaggeredDerivative makes them (transforms.cl).
class Derivative {
public:
    /// Of an axis with more than one point.
    Derivative(const Device& device, const Slabs& slabs, std::size_t axis);
    void derive(fft::HalfCell shift, const Buffer& from, const Buffer& to) const;

private:
    const Device& device_;
    /// Complex lines are bundled; a group of work items transforms a bundle.
    std::size_t width_ = 8, bundles_ = 0, group_ = 64;
    std::ptrdiff_t columns_ = 0, plane_ = 0;
    Kernels kernels_;
    Buffer forward_, back_, roots_, space_;
};

} // namespace shearwake::pstd::gpu
