#pragma once

#include "model/plan.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace shearwake {

/// A case as plan.json lists it.
struct IndexedCase {
    std::string id;
    std::vector<Setting> settings;
    bool is_reference = false;
    std::string reference_id;
};

/// What every later stage needs to know of a plan.
struct PlanIndex {
    std::string name;
    std::string title;
    std::vector<std::string> swept_keys;
    TableOptions table;
    std::vector<IndexedCase> cases;
};

/// plan.json: cases, ids, settings and canonical texts. Equal plans give equal text.
std::string plan_text(const Plan& plan);

/// Throws UsageError (environment) when it is missing or no plan. Not collective.
PlanIndex read_plan(const std::filesystem::path& path);

/// The settings of one case as one JSON object.
std::string settings_text(const std::vector<Setting>& settings);

} // namespace shearwake
