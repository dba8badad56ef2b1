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

/// The step that the options give; or the longest whose expected error is below the accuracy, from
/// the fastest of waves, scan and envelope, the losses, and the stabilisation that elements and
/// bodies need. Divides the output interval. Not collective.
TimeStep choose_time_step(const Case& c, const SpectralOptions& options);

} // namespace shearwake
