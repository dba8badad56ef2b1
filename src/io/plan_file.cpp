#include "io/plan_file.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "io/files.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace shearwake {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const std::vector<Setting>& settings) {
    Json object = Json::object();
    for (const Setting& setting : settings)
        std::visit([&](const auto& value) { object[setting.key] = value; }, setting.value);
    return object;
}

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

/// Names become those of files. They may come from anywhere: they must stay in their folder.
std::string file_name(const Json& entry, const std::filesystem::path& path) {
    const auto name = entry.get<std::string>();
    if (is_file_name(name)) return name;
    throw UsageError(fmt::format("{} is no plan of this program: {:.99} names something outside of "
                                 "its folder, or is no name of a file",
                                 path.string(), entry.dump()),
                     ExitCode::environment);
}

} // namespace

std::string settings_text(const std::vector<Setting>& settings) {
    return json_of(settings).dump();
}

std::string plan_text(const Plan& plan) {
    Json root;
    root["schema"] = 1;
    root["name"] = plan.name;
    root["title"] = plan.title;
    root["swept_keys"] = plan.swept_keys;
    root["table"]["x"] = plan.table.x;
    root["table"]["series"] = plan.table.series;
    root["cases"] = Json::array();
    for (const PlannedCase& c : plan.cases) {
        Json entry;
        entry["id"] = c.id;
        entry["settings"] = json_of(c.settings);
        entry["is_reference"] = c.is_reference;
        entry["reference_id"] = c.reference_id;
        entry["case"] = canonical_text(c.physics);
        root["cases"].push_back(std::move(entry));
    }
    return root.dump(1) + "\n";
}

PlanIndex read_plan(const std::filesystem::path& path) {
    const std::string text = read_file(path);
    try {
        const Json root = Json::parse(text);
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
        throw UsageError(path.string() + " is no plan: " + error.what(), ExitCode::environment);
    }
}

} // namespace shearwake
