#pragma once

#include "model/material_map.hpp"

#include <functional>
#include <memory>
#include <string>

namespace shearwake {

/// Gives the map in the file that medium.map names; throws UsageError, on all ranks alike. Maps
/// come in through this, since reading a job touches no files. The same file gives the same map.
using MapLoader = std::function<std::shared_ptr<const MaterialMap>(const std::string& file)>;

} // namespace shearwake
