// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/study_data.hpp"
#include "problem/load/acoustics/lens_design.hpp"
#include "problem/medium/material_map.hpp"

#include <functional>
#include <memory>
#include <string>

namespace shearwake::config {

/// Returns the study in the file that solver.pstd.study names; throws UsageError on all ranks. The
/// same file gives the same study.
using StudyLoader = std::function<std::shared_ptr<const StudyData>(const std::string& file)>;

/// Returns the map in the file that medium.map names; throws UsageError on all ranks. The reader of
/// a job uses it, since it does not access files itself. The same file gives the same map.
using MapLoader = std::function<std::shared_ptr<const MaterialMap>(const std::string& file)>;

/// Returns the text of a file that a path names; throws UsageError on all ranks.
using TextLoader = std::function<std::string(const std::string& file)>;

/// Loaders of the files that a job names, and the lenses that it has designed. Without a loader,
/// such files are rejected.
struct FileLoaders {
    MapLoader load_map;
    TextLoader load_text;
    StudyLoader load_study;
    std::shared_ptr<LensDesigns> lenses = std::make_shared<LensDesigns>();
};

} // namespace shearwake::config
