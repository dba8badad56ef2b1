#pragma once

#include "model/case.hpp"

#include <cstddef>
#include <string>

namespace shearwake {

/// The step of a case: a whole number of them is an output interval.
struct TimeStep {
    double step_s = 0.0;
    std::ptrdiff_t per_frame = 1;
    std::string why; // one line: how long, and what decided it
};

/// The step that the options give; or the longest whose expected error is below the accuracy:
/// probed_error of the layers under the load, and what stiff bodies add. Divides the output
/// interval. Takes as long as the probe, about 0.1 s at most for usual cases. Not collective.
TimeStep choose_time_step(const Case& c, const SpectralOptions& options);

} // namespace shearwake
