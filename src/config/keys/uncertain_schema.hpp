// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace shearwake::config {

/// The JSON Schema of [uncertain]: its own keys, and full keys of a case with their distributions.
nlohmann::ordered_json uncertain_schema();

} // namespace shearwake::config
