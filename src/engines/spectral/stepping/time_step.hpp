// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/depth/depth_mesh.hpp"
#include "problem/case/case.hpp"

#include <cstddef>
#include <string>

namespace shearwake::spectral {

/// Time step of a case; an integer number of steps makes one output interval.
struct TimeStep {
    double step_s = 0.0;
    std::ptrdiff_t per_frame = 1;
    std::string why; // one line: the length and its reason
};

/// The step that the options specify, or the longest one whose estimated error is within the
/// accuracy: probed_error() of the layers under the load plus the error due to stiff bodies. It
/// divides the output interval. Takes about 0.1 s at most for common cases. Not collective.
TimeStep choose_time_step(const Case& c, const SpectralOptions& options);

/// The mesh for the step of choose_time_step(). Not collective.
DepthMesh choose_mesh(const Case& c, const SpectralOptions& options);

} // namespace shearwake::spectral
