// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/remark.hpp"

#include <string>
#include <vector>

namespace shearwake::pstd {

/// The reason why a case does not match the grid study of its solver: domain, times, depths, or
/// keys that have no effect with a study. Empty if it matches or has no study.
std::string study_trouble(const Case& c);

/// An error if the time step of the study is certainly unstable, a warning if it may be.
std::vector<Remark> study_step_remarks(const StudyData& study);

} // namespace shearwake::pstd
