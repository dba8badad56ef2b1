// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "parallel/comm.hpp"
#include "pipeline/case_content.hpp"
#include "pipeline/memory.hpp"
#include "pipeline/surface_recorder.hpp"
#include "problem/case/plan.hpp"

#include <optional>

namespace shearwake::pipeline {

/// Computes the field of a case and what follows from it: the only place that does. Every command
/// differs in its sinks alone. Returns nothing if `sinks.checkpoints` stopped the case. Throws
/// FieldDiverges if the field is not finite, otherwise CaseFailure or UsageError, on all ranks
/// together. Collective over the team.
std::optional<CaseResults> compute(const PlannedCase& planned, const CasePlan& plan,
                                   engines::FrameSource& engine, const Comm& team,
                                   const Sinks& sinks);

} // namespace shearwake::pipeline
