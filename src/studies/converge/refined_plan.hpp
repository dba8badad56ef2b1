// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/plan.hpp"
#include "studies/converge/refinement.hpp"

#include <span>
#include <string>
#include <vector>

namespace shearwake::converge {

/// A case whose convergence is studied.
struct StudiedCase {
    const PlannedCase* planned = nullptr; // in the plan of the sweep
    std::string base_id;                  // of the case without fields
    std::vector<Refinement> refinements;
    std::vector<std::string> refined_ids; // of `refinements`
};

/// The plan of a convergence study: each selected case and each of its refinements once.
struct RefinedPlan {
    Plan plan; // named like the sweep
    std::vector<StudiedCase> cases;
};

/// The cases with the ids in `only`, or without any, `count` cases from the first to the last of
/// the sweep. The references of these cases are added. Throws UsageError for an unknown id and for
/// grid studies. `plan` must outlive the result. Not collective.
RefinedPlan refined_plan(const Plan& plan, std::span<const std::string> only, std::size_t count);

} // namespace shearwake::converge
