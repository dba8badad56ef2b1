// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/json.hpp"
#include "problem/case/plan.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace shearwake::storage {

/// A case as plan.json lists it.
struct IndexedCase {
    std::string id;
    std::vector<Setting> settings;
    bool is_reference = false;
    std::string reference_id;
    std::optional<std::size_t> sample = std::nullopt; // row of the design of [uncertain]
};

/// The part of a plan that later stages require.
struct PlanIndex {
    std::string name;
    std::string title;
    std::vector<std::string> swept_keys;
    TableOptions table;
    std::vector<IndexedCase> cases;
    std::optional<UncertainPlan> uncertain = std::nullopt;
    std::vector<AdaptiveAxis> adaptive = {};
};

/// The text of plan.json: cases, ids, settings and canonical texts, with a checksum of the whole.
/// Equal plans give equal text.
std::string plan_text(const Plan& plan);

/// How the text of a plan.json relates to a plan.
/// `extended`: the plan contains the same sample of [uncertain] with more points, or the same
/// adaptive axes with more points, and so all cases of the text.
enum class PlanMatch { same, extended, another, damaged };
PlanMatch compare_plan(const std::string& text, const Plan& plan);

/// Throws UsageError (environment) if it is missing, damaged or not a plan. Not collective.
PlanIndex read_plan(const std::filesystem::path& path);

/// The settings of one case as a JSON object {key: value}.
Json settings_json(const std::vector<Setting>& settings);

/// The same as text on one line.
std::string settings_text(const std::vector<Setting>& settings);

} // namespace shearwake::storage
