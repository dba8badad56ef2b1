// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pipeline/surface_recorder.hpp"
#include "problem/case/plan.hpp"

#include <string>
#include <vector>

namespace shearwake::pipeline {

/// The results of a case in addition to its surface fields.
struct CaseResults {
    std::vector<VariableGroup> groups;  // as in the case file; on rank 0 only
    std::vector<std::string> afferents; // warnings about the afferents, one line each
};

/// Reduces what was recorded to the groups of a case file and computes the response of the
/// afferents. Call after recorder.finish(). Collective.
CaseResults case_results(const PlannedCase& planned, const SurfaceRecorder& recorder,
                         const Comm& team);

} // namespace shearwake::pipeline
