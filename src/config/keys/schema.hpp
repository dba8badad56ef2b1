// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace shearwake::config {

/// The JSON Schema (2020-12) of job files, from the descriptions of the structs (base/field.hpp):
/// types, units, ranges, defaults and meanings of all keys. Editors complete and check jobs by it.
/// What depends on several keys at once, on files or on the physics, only `check` reports.
std::string job_schema();

/// The keys of a job in full, such as "load.peak_Pa" and "medium.layer[1].c_s_m_s".
std::vector<std::string> key_names();

/// "did you mean load.peak_Pa?" for the end of a key, such as "peak_Pa". Empty if no key of a job
/// ends in this way, or more than three do.
std::string full_key_hint(std::string_view ending);

} // namespace shearwake::config
