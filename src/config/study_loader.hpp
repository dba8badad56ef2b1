#pragma once

#include "model/grid_study.hpp"

#include <functional>
#include <memory>
#include <string>

namespace shearwake {

/// Gives the study in the file that solver.pstd.study names; throws UsageError, on all ranks alike.
/// The same file gives the same study.
using StudyLoader = std::function<std::shared_ptr<const GridStudy>(const std::string& file)>;

} // namespace shearwake
