// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/files/map_loader.hpp"
#include "config/files/study_loader.hpp"
#include "problem/load/acoustics/lens_design.hpp"

#include <functional>
#include <string>

namespace shearwake::config {

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
