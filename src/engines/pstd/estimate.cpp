// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/estimate.hpp"

#include <fmt/format.h>

namespace shearwake::pstd {
namespace {

/// Values that a step reads and writes per point: totals, stored parts, and the transforms of
/// gradients.
double values_per_point(Absorption absorption) {
    return absorption != Absorption::none ? 9.0 + 15.0 + 15.0 : 9.0 + 15.0 + 6.0;
}

} // namespace

engines::MarchWork march_work(const Case& c, const StepWork& work) {
    const double columns = static_cast<double>(c.domain.nx * c.domain.ny);
    const double frames = static_cast<double>(c.time.frames);
    const double given = columns * static_cast<double>(c.measure.depths_m.size()) * frames;
    return {.kind = fmt::format(
                "pstd {}{}{}", work.precision == Precision::single_precision ? "single" : "double",
                work.absorption != Absorption::none ? " lossy" : "", work.uneven ? " uneven" : ""),
            .unknowns =
                values_per_point(work.absorption) * work.points + columns + given / work.steps,
            .steps = work.steps};
}

double stepper_memory_B(const StepWork& work) {
    const bool lossy = work.absorption != Absorption::none;
    const double of_value_B = work.precision == Precision::single_precision ? 4.0 : 8.0;
    const double coefficients = !work.uneven ? 0.0 : lossy ? 13.0 : 8.0;
    return engines::program_B + of_value_B * (values_per_point(work.absorption) + coefficients) *
                                    work.points / work.ranks;
}

} // namespace shearwake::pstd
