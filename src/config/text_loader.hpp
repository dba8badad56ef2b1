#pragma once

#include "config/map_loader.hpp"
#include "config/study_loader.hpp"

#include <functional>
#include <string>

namespace shearwake {

/// Gives the text of a file that a path names; throws UsageError, on all ranks alike.
using TextLoader = std::function<std::string(const std::string& file)>;

/// What brings in the files that a job names. One that is missing refuses them.
struct FileLoaders {
    MapLoader load_map;
    TextLoader load_text;
    StudyLoader load_study;
};

} // namespace shearwake
