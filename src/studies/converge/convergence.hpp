// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"
#include "problem/case/case.hpp"
#include "problem/case/plan.hpp"
#include "schedule/run/run.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace shearwake::converge {

/// A case with one numerical parameter refined.
struct Refinement {
    std::string name;   // "spacing", "time", "domain"
    std::string change; // "half the spacing, 0.5 mm"
    Case physics;
    /// Ratio by which the refined quantity, the spacing or the step, is smaller.
    double ratio = 2.0;
    /// Order of convergence of the measures in that quantity; none: unknown.
    std::optional<double> order;
};

/// The case without frames and volumes in its record, which are not needed.
Case without_fields(Case c);

/// The case with half the spacing, with half the time step (or a quarter of the tolerance), and
/// with twice the domain. Each keeps all other parameters, and the measured region. Not collective.
std::vector<Refinement> refinements(const Case& c);

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
/// the sweep. The references of these cases are added. Throws UsageError for an unknown id. `plan`
/// must outlive the result. Not collective.
RefinedPlan refined_plan(const Plan& plan, std::span<const std::string> only, std::size_t count);

/// The studied cases and their refinements as JSON, from which shearwake.studies.convergence
/// estimates the errors.
std::string json_text(const RefinedPlan& refined);

/// Arguments of `run`, of which `out` is the folder of the sweep, and `only` the cases to study.
struct ConvergeArguments : schedule::RunArguments {
    std::size_t cases = 3; // without `only`: number of cases to study
};

/// The command `converge`: computes refined cases in the subfolder `converge`, and lets
/// shearwake.studies.convergence estimate the errors of all columns. Collective over the world.
ExitCode converge_job(const ConvergeArguments& arguments, const Comm& world);

} // namespace shearwake::converge
