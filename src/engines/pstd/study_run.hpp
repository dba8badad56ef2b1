// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/pstd/scheme/stepper.hpp"
#include "problem/case/case.hpp"
#include "problem/case/plan.hpp"
#include "problem/case/study_data.hpp"

#include <set>
#include <string>
#include <vector>

namespace shearwake::pstd {

/// The material of each node of a study, which must exist as long as the function.
MaterialOfNode material_of(const StudyData& study);

/// Whether the material differs between nodes.
bool is_uneven(const StudyData& study);

/// The grid, absorbing layer, medium and sources of a study, which must exist as long as the setup.
Setup study_setup(const StudyData& study);

/// The names of what the sensor of a study records.
std::set<std::string> records_of(const StudyData& study);

/// Runs a case whose PstdOptions refer to a grid study: grid, absorbing layer, medium and sources
/// are those of the study. Frames contain the displacement at the points of the domain and the
/// measured depths (node k of z is at k d, u_z half a cell below). The series of the sensor are
/// part of the report in `solved`. Throws CaseFailure on all ranks together if the domain or times
/// of the case do not match the study. Collective.
void run_study(const Case& c, const Comm& team, engines::Observer& observer,
               engines::Checkpoints* checkpoints);

/// The decisions for a grid study, one line each, and its resources. Not collective.
std::vector<std::string> study_notes(const Case& c);
engines::Resources study_resources(const Case& c, int ranks);

/// The reason why a case does not match the grid study of its solver: domain, times, depths, or
/// keys that have no effect with a study. Empty if it matches or has no study.
std::string study_error(const Case& c);

/// An error if the time step of the study is certainly unstable, a warning if it may be.
std::vector<Remark> study_step_remarks(const StudyData& study);

} // namespace shearwake::pstd
