// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/gpu/device.hpp"
#include "engines/pstd/scheme/grid.hpp"
#include "fft/staggered_derivative.hpp"

namespace shearwake::pstd::gpu {

/// The radices of an FFT of n points: 8, 4, 2, 3, 5 and other primes.
std::vector<std::ptrdiff_t> radices_of(std::ptrdiff_t n);

/// Spectral derivatives along an axis, as fft::StaggeredDerivative makes them (transforms.cl).
template <class Real>
class Derivative {
public:
    Derivative(const Device& device, const Slabs& slabs, std::size_t axis);

    /// Bytes of its tables and of global memory where lines are too long for local memory.
    static double memory_B(const Device& device, const Slabs& slabs, std::size_t axis);
    /// Not for an axis with one point, whose derivative is 0.
    void derive(fft::HalfCell shift, const Buffer<Real>& from, const Buffer<Real>& to) const;

private:
    /// How lines are bundled.
    struct Bundles {
        std::ptrdiff_t width = 1, count = 0, group = 64;
        std::size_t space_B = 0; // of a bundle
        bool is_local = true;
    };
    static Bundles bundles_of(const Device& device, const Slabs& slabs, std::size_t axis);

    const Device& device_;
    Bundles bundles_;
    cl_long columns_ = 0, plane_ = 0;
    Kernel kernel_;
    Buffer<Real> forward_, back_, roots_, space_;
};

} // namespace shearwake::pstd::gpu
