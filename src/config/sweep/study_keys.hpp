// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/sweep/override.hpp"
#include "config/sweep/sweep_axes.hpp"
#include "problem/case/plan.hpp"

#include <span>

namespace shearwake::config {

/// Reports swept keys and overrides that have no effect on the grid studies of a plan: those of
/// [medium] and [load], which a study replaces.
void check_study_keys(const Plan& plan, const Sweep& sweep, std::span<const Override> overrides,
                      DiagnosticList& diagnostics);

} // namespace shearwake::config
