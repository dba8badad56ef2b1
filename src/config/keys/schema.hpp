// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace shearwake::config {

/// The JSON Schema (2020-12) of job files, from the descriptions of the structs (base/field.hpp):
/// types, units, ranges, defaults and meanings of all keys. Editors complete and check jobs by it.
/// What depends on several keys at once, on files or on the physics, only `check` reports.
std::string job_schema();

} // namespace shearwake::config
