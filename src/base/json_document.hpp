// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace shearwake {

/// Version of the documents that commands print with --json. A change that removes or renames a
/// member, or changes its meaning, increases it. docs/reference/json-output.md describes them.
inline constexpr int json_schema_version = 1;

/// The text of such a document: an object with `schema`, `command`, and then `members`. Numbers
/// that are not finite become null, and invalid UTF-8 is replaced.
std::string json_document(std::string_view command, const nlohmann::ordered_json& members);

} // namespace shearwake
