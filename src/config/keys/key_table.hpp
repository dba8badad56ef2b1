// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace shearwake::config {

/// The Markdown reference of all keys of a case, with one table per table of the job. It is
/// generated from the descriptions next to the structs (base/field.hpp). The site shows it.
std::string key_reference();

/// The values of all presets as TOML, with their sources as comments.
std::string preset_reference();

enum class Draft { draft_7, draft_2020_12 };

/// The JSON Schema of job files, from the descriptions of the structs (base/field.hpp): types,
/// units, ranges, defaults and meanings of all keys. Editors complete and check jobs by it. What
/// depends on several keys at once, on files or on the physics, only `check` reports.
std::string job_schema(Draft draft);

/// "did you mean load.peak_Pa?" for the end of a key, such as "peak_Pa". Empty if no key of a job
/// ends in this way, or more than three do.
std::string full_key_hint(std::string_view ending);

} // namespace shearwake::config
