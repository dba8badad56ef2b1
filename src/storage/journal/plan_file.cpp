// SPDX-License-Identifier: BSD-3-Clause
#include "storage/journal/plan_file.hpp"

#include "base/error.hpp"
#include "base/json_line.hpp"
#include "base/text.hpp"
#include "storage/files.hpp"
#include "storage/checksum/sealed_text.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace shearwake::storage {
namespace {

using Json = nlohmann::ordered_json;

std::vector<Setting> settings_of(const Json& object) {
    std::vector<Setting> settings;
    for (const auto& [key, value] : object.items()) {
        if (value.is_number())
            settings.push_back({key, value.get<double>()});
        else
            settings.push_back({key, value.get<std::string>()});
    }
    return settings;
}

constexpr int schema = 2, schema_without_checksum = 1;

/// Whether a text is a JSON object that matches its checksum or was written by an earlier version.
bool is_sound(const std::string& text) {
    const Unsealed unsealed = unseal(text);
    const Json root = Json::parse(unsealed.text, nullptr, false);
    if (root.is_discarded() || !root.is_object()) return false;
    if (unsealed.seal != Seal::none) return unsealed.seal == Seal::sound;
    return root.contains("schema") && root.at("schema") == schema_without_checksum;
}

/// Names are used as file names. Since they are untrusted input, they must not lead outside their
/// folder.
std::string file_name(const Json& entry, const std::filesystem::path& path) {
    const auto name = entry.get<std::string>();
    if (is_file_name(name)) return name;
    throw UsageError(fmt::format("{} is not a plan of this program: {:.99} is not a valid file "
                                 "name, or refers to a file outside the folder",
                                 path.string(), entry.dump()),
                     ExitCode::environment);
}

} // namespace

Json settings_json(const std::vector<Setting>& settings) {
    Json object = Json::object();
    for (const Setting& setting : settings)
        std::visit([&](const auto& value) { object[setting.key] = value; }, setting.value);
    return object;
}

std::string settings_text(const std::vector<Setting>& settings) {
    JsonLine line;
    for (const Setting& setting : settings)
        std::visit([&](const auto& value) { line.add(setting.key, value); }, setting.value);
    return line.text();
}

std::string plan_text(const Plan& plan) {
    Json root;
    root["schema"] = schema;
    root["name"] = plan.name;
    root["title"] = plan.title;
    root["swept_keys"] = plan.swept_keys;
    root["table"]["x"] = plan.table.x;
    root["table"]["series"] = plan.table.series;
    root["cases"] = Json::array();
    for (const PlannedCase& c : plan.cases) {
        Json entry;
        entry["id"] = c.id;
        entry["settings"] = settings_json(c.settings);
        entry["is_reference"] = c.is_reference;
        entry["reference_id"] = c.reference_id;
        entry["case"] = canonical_text(c.physics);
        root["cases"].push_back(std::move(entry));
    }
    return seal(root.dump(1) + "\n");
}

PlanMatch compare_plan(const std::string& text, const Plan& plan) {
    const Unsealed there = unseal(text), wanted = unseal(plan_text(plan));
    if (there.text == wanted.text && there.seal == Seal::sound) return PlanMatch::same;
    if (!is_sound(text)) return PlanMatch::damaged;
    // Plans of earlier versions have another schema and no checksum.
    const auto rest = [](const std::string& json) {
        Json root = Json::parse(json);
        root.erase("schema");
        return root;
    };
    return rest(there.text) == rest(wanted.text) ? PlanMatch::same : PlanMatch::another;
}

PlanIndex read_plan(const std::filesystem::path& path) {
    std::error_code trouble; // other than a missing file; read_file reports it
    if (!std::filesystem::exists(path, trouble) && !trouble) {
        const std::filesystem::path folder = path.parent_path();
        const bool is_folder = std::filesystem::is_directory(folder, trouble);
        const char* reason = is_folder ? " is not an output folder, since it contains no plan.json"
                                       : ": no such output folder";
        throw UsageError(fmt::format("{}{}; run the job first", folder.string(), reason),
                         ExitCode::environment);
    }
    const std::string text = read_file(path);
    if (!is_sound(text))
        throw UsageError(fmt::format("{} is not a plan, or is damaged: it is truncated or does not "
                                     "match its checksum; rerun its job to restore it",
                                     path.string()),
                         ExitCode::environment);
    try {
        const Json root = Json::parse(unseal(text).text);
        PlanIndex index;
        index.name = file_name(root.at("name"), path);
        index.title = root.at("title").get<std::string>();
        index.swept_keys = root.at("swept_keys").get<std::vector<std::string>>();
        index.table.x = root.at("table").at("x").get<std::string>();
        index.table.series = root.at("table").at("series").get<std::vector<std::string>>();
        for (const Json& entry : root.at("cases"))
            index.cases.push_back({.id = file_name(entry.at("id"), path),
                                   .settings = settings_of(entry.at("settings")),
                                   .is_reference = entry.at("is_reference").get<bool>(),
                                   .reference_id = entry.at("reference_id").get<std::string>()});
        return index;
    } catch (const nlohmann::json::exception& error) {
        throw UsageError(path.string() + " is not a plan: " + error.what(), ExitCode::environment);
    }
}

} // namespace shearwake::storage
