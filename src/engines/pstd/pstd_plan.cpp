// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/pstd_plan.hpp"

#include <fmt/format.h>

namespace shearwake::pstd {
namespace {

/// Values per point of the totals and parts of velocity and stress, and of the transforms of
/// gradients.
struct ValuesPerPoint {
    double fields = 9.0 + 15.0, transforms = 6.0;
    explicit ValuesPerPoint(Absorption absorption) {
        if (absorption != Absorption::none) transforms = 15.0;
    }
};

} // namespace

engines::MarchWork march_work(const Case& c, const PstdPlan& plan) {
    const ValuesPerPoint values(plan.absorption);
    const double columns = static_cast<double>(c.domain.nx * c.domain.ny);
    const double frames = static_cast<double>(c.time.frames);
    const double given = columns * static_cast<double>(c.measure.depths_m.size()) * frames;
    return {.kind = fmt::format(
                "pstd {}{}{}", plan.precision == Precision::single_precision ? "single" : "double",
                plan.absorption != Absorption::none ? " lossy" : "", plan.uneven ? " uneven" : ""),
            .unknowns =
                (values.fields + values.transforms) * plan.points + columns + given / plan.steps,
            .steps = plan.steps};
}

std::vector<engines::Array> arrays_of_stepper(const PstdPlan& plan, int ranks) {
    const bool lossy = plan.absorption != Absorption::none;
    const ValuesPerPoint values(plan.absorption);
    const double of_value_B = plan.precision == Precision::single_precision ? 4.0 : 8.0;
    const double array_B = of_value_B * plan.points / ranks;
    return {{"velocity and stress with their parts", values.fields * array_B},
            {"transforms of gradients", values.transforms * array_B},
            {"coefficients of nodes", !plan.uneven ? 0.0 : (lossy ? 13.0 : 8.0) * array_B}};
}

} // namespace shearwake::pstd
