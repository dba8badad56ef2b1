// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/engine.hpp"
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
/// divides the output interval. Takes about 0.1 s at most for common cases. Throws
/// engines::StepNotChosen, at once if the limit is finite and the mesh has more than 1000 elements
/// of degree 8. Not collective.
TimeStep choose_time_step(const Case& c, const SpectralOptions& options,
                          engines::ChoiceLimit limit = {});

/// The mesh for the step of choose_time_step(). Not collective.
DepthMesh choose_mesh(const Case& c, const SpectralOptions& options);

// Estimates of the error (step_probe.cpp).

/// The steps of the first 2500 frames at most.
long steps_to_probe(const Case& c, double step_s);

/// Relative L2 error of the surface field that a time step causes in the layers, without bodies and
/// maps. A few wave vectors of the case's load, without steering of its pattern, are advanced with
/// this step and with half of it for the duration of the run. Their difference is 15/16 of an error
/// of fourth order, and 3/4 of one of second order (viscous forces). A run of more than 2500
/// frames, or of more than 100 000 steps times elements, is extrapolated from a first part in which
/// the load acts. Takes at most about 2 s, unless the load begins late. Throws
/// engines::StepNotChosen. Not collective.
double probed_error(const Case& c, const DepthMesh& mesh, double step_s,
                    engines::ChoiceLimit limit = {});

/// Estimated errors of the surface field, without bodies and maps.
struct ProbedErrors {
    double norm = 0.0;     // relative L2 error of all frames
    double maximum = 0.0;  // largest error near the focus, relative to the largest value there
    double absorber = 0.0; // the part of `norm` that the absorber of a half-space causes
};

/// Estimates the errors that the step, the elements and the absorber cause, from differences: from
/// half the step and half the length of the elements at samples of the spectrum of the footprint,
/// and from an absorber of twice the depth at the lowest wave vectors of the domain, where it
/// returns the most. Covers at most 2500 frames as probed_error() does. Not collective.
ProbedErrors probed_errors(const Case& c, const SpectralOptions& options, double step_s);

} // namespace shearwake::spectral
