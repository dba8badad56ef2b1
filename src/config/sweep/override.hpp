// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/tree.hpp"
#include "config/sweep/sweep.hpp"
#include "problem/case/plan.hpp"

#include <span>
#include <string>
#include <string_view>

namespace shearwake::config {

/// -S key=value. The value is TOML; a bare word that is not valid TOML is read as a string.
struct Override {
    std::string key;
    std::string value;
};

/// The place of an override in messages: "-S load.peak_Pa".
Place place_of(const Override& override);

/// Applies the override to `root`, whose [sweep] must be flattened. After an error, returns `root`
/// unchanged and reports a diagnostic.
NodePtr with_override(const NodePtr& root, const Override& override, DiagnosticList& diagnostics);

/// Warns of overrides of keys that vary, of parts of them, and of tables that contain them: each
/// case has its own value. `root` is the job after the overrides.
void check_overrides(const NodePtr& root, std::span<const Override> overrides,
                     std::span<const std::string> varied, DiagnosticList& diagnostics);

/// The job after overrides as TOML. A comment at each value that an override has set contains the
/// value of `before`, the job without overrides. Of the other comments, only that at the beginning
/// of `file_text` is contained, which states the question of the job.
std::string text_with_overrides(const NodePtr& before, const NodePtr& after,
                                const std::string& file_name, std::string_view file_text);

} // namespace shearwake::config
