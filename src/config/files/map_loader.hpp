// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/medium/material_map.hpp"

#include <functional>
#include <memory>
#include <string>

namespace shearwake::config {

/// Returns the map in the file that medium.map names; throws UsageError on all ranks. The reader of
/// a job uses it, since it does not access files itself. The same file gives the same map.
using MapLoader = std::function<std::shared_ptr<const MaterialMap>(const std::string& file)>;

} // namespace shearwake::config
