// SPDX-License-Identifier: BSD-3-Clause
#include "config/sweep/study_keys.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::config {
namespace {

constexpr const char* reason =
    "has no effect on the imported simulation: its medium and its sources are those of the file in "
    "solver.pstd.study";

bool is_replaced(const Path& path) {
    return !path.empty() && (path.front().key == "medium" || path.front().key == "load");
}

} // namespace

void check_study_keys(const Plan& plan, const Sweep& sweep, std::span<const Override> overrides,
                      DiagnosticList& diagnostics) {
    const bool any = std::ranges::any_of(
        plan.cases, [](const PlannedCase& planned) { return planned.physics.study() != nullptr; });
    if (!any) return;
    for (const Axis& axis : sweep.axes)
        for (const SweptKey& key : axis.keys)
            if (is_replaced(key.path))
                diagnostics.error(key.at,
                                  fmt::format("sweep: {} {}; import one simulation per value and "
                                              "sweep solver.pstd.study",
                                              key.key, reason));
    for (const Override& override : overrides)
        if (is_replaced(split_path(override.key).value_or(Path{})))
            diagnostics.error(
                place_of(override),
                fmt::format("{} {}; change it in k-Wave and import it again. Only the "
                            "measures use [medium] and [load], which are changed in "
                            "the job file",
                            override.key, reason));
}

} // namespace shearwake::config
