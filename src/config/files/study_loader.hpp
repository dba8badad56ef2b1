// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/study_data.hpp"

#include <functional>
#include <memory>
#include <string>

namespace shearwake::config {

/// Returns the study in the file that solver.pstd.study names; throws UsageError on all ranks. The
/// same file gives the same study.
using StudyLoader = std::function<std::shared_ptr<const StudyData>(const std::string& file)>;

} // namespace shearwake::config
