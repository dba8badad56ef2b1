// SPDX-License-Identifier: BSD-3-Clause
#include "storage/journal/plan_file.hpp"

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "storage/checksum/checksum.hpp"
#include "storage/files.hpp"

#include <fmt/format.h>
#include <set>

namespace shearwake::storage {
namespace {

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

constexpr int schema = 2;

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

Json json_of(const UncertainPlan& uncertain) {
    Json exceedance = Json::object();
    for (const Threshold& threshold : uncertain.exceedance)
        exceedance[threshold.column] = threshold.value;
    return {{"keys", uncertain.keys},         {"sampling", uncertain.sampling},
            {"analysis", uncertain.analysis}, {"samples", uncertain.samples},
            {"seed", uncertain.seed},         {"exceedance", exceedance}};
}

std::optional<UncertainPlan> uncertain_of(const Json& root) {
    const Json* found = root.find("uncertain");
    if (!found) return std::nullopt;
    UncertainPlan uncertain{.keys = found->at("keys").get<std::vector<std::string>>(),
                            .sampling = found->at("sampling").get<std::string>(),
                            .analysis = found->at("analysis").get<std::string>(),
                            .samples = found->at("samples").get<std::size_t>(),
                            .seed = found->at("seed").get<std::uint64_t>(),
                            .exceedance = {}};
    for (const auto& [column, value] : found->at("exceedance").items())
        uncertain.exceedance.push_back({column, value.get<double>()});
    return uncertain;
}

Json json_of(const AdaptiveAxis& axis) {
    Json json = {{"key", axis.key},
                 {"goal", name_of(axis.goal)},
                 {"first", axis.first},
                 {"last", axis.last},
                 {"column", axis.column},
                 {"tolerance", axis.tolerance},
                 {"smallest_step", axis.smallest_step},
                 {"initial", axis.initial},
                 {"most", axis.most}};
    if (axis.has_level) json["level"] = axis.level;
    return json;
}

AdaptiveAxis adaptive_axis_of(const Json& json) {
    using Goal = AdaptiveAxis::Goal;
    AdaptiveAxis axis{.key = json.at("key").get<std::string>(),
                      .first = json.at("first").get<double>(),
                      .last = json.at("last").get<double>(),
                      .column = json.at("column").get<std::string>(),
                      .tolerance = json.at("tolerance").get<double>(),
                      .smallest_step = json.at("smallest_step").get<double>(),
                      .has_level = json.contains("level"),
                      .initial = json.at("initial").get<std::size_t>(),
                      .most = json.at("most").get<std::size_t>()};
    for (const Goal goal : {Goal::refine, Goal::maximum, Goal::minimum, Goal::crossing})
        if (json.at("goal") == name_of(goal)) axis.goal = goal;
    if (axis.has_level) axis.level = json.at("level").get<double>();
    return axis;
}

std::optional<std::size_t> sample_of(const Json& entry) {
    const Json* found = entry.find("sample");
    return found ? std::optional(found->get<std::size_t>()) : std::nullopt;
}

/// Whether `now` has all cases of `before` and differs only in the number of samples, in the
/// thresholds and in the points and tolerances of adaptive axes, which have no effect on cases.
bool is_extension(Json before, Json now) {
    const auto both_have = [&](const char* key) {
        return before.contains(key) && now.contains(key);
    };
    if (!both_have("cases") || (!both_have("uncertain") && !both_have("adaptive"))) return false;
    std::set<std::string> ids;
    for (const Json& entry : now.at("cases"))
        ids.insert(entry.at("id").get<std::string>());
    for (const Json& entry : before.at("cases"))
        if (!ids.contains(entry.at("id").get<std::string>())) return false;
    for (Json* root : {&before, &now}) {
        for (const char* key : {"checksum", "cases", "title", "table"})
            root->erase(key);
        if (root->contains("uncertain"))
            for (const char* key : {"samples", "exceedance"})
                root->at("uncertain").erase(key);
        if (root->contains("adaptive"))
            for (Json& axis : root->at("adaptive"))
                for (const char* key : {"tolerance", "smallest_step", "initial", "most"})
                    axis.erase(key);
    }
    return before == now;
}

} // namespace

Json settings_json(const std::vector<Setting>& settings) {
    Json object = Json::object();
    for (const Setting& setting : settings)
        std::visit([&](const auto& value) { object[setting.key] = value; }, setting.value);
    return object;
}

std::string settings_text(const std::vector<Setting>& settings) {
    return settings_json(settings).text();
}

std::string plan_text(const Plan& plan) {
    Json root = {{"schema", schema},
                 {"name", plan.name},
                 {"title", plan.title},
                 {"swept_keys", plan.swept_keys},
                 {"table", {{"x", plan.table.x}, {"series", plan.table.series}}}};
    if (plan.uncertain) root["uncertain"] = json_of(*plan.uncertain);
    for (const AdaptiveAxis& axis : plan.adaptive)
        root["adaptive"].push_back(json_of(axis));
    root["cases"] = Json::array();
    for (const PlannedCase& c : plan.cases) {
        Json entry = {{"id", c.id},
                      {"settings", settings_json(c.settings)},
                      {"is_reference", c.is_reference},
                      {"reference_id", c.reference_id}};
        if (c.sample) entry["sample"] = *c.sample;
        entry["case"] = canonical_text(c.physics);
        root["cases"].push_back(std::move(entry));
    }
    return seal(root.dump(1) + "\n");
}

PlanMatch compare_plan(const std::string& text, const Plan& plan) {
    const std::string wanted = plan_text(plan);
    if (text == wanted) return PlanMatch::same;
    const Json there = Json::parse_or_null(unseal(text).value_or(""));
    if (!there.is_object()) return PlanMatch::damaged;
    return is_extension(there, Json::parse(wanted)) ? PlanMatch::extended : PlanMatch::another;
}

PlanIndex read_plan(const std::filesystem::path& path) {
    std::error_code file_error; // other than a missing file; read_file reports it
    if (!std::filesystem::exists(path, file_error) && !file_error) {
        const std::filesystem::path folder = path.parent_path();
        const bool is_folder = std::filesystem::is_directory(folder, file_error);
        const char* reason = is_folder ? " is not an output folder, since it contains no plan.json"
                                       : ": no such output folder";
        throw UsageError(fmt::format("{}{}; run the job first", folder.string(), reason),
                         ExitCode::environment);
    }
    const std::optional<std::string> text = unseal(read_file(path));
    if (!text)
        throw UsageError(fmt::format("{} is not a plan, or is damaged: it is truncated or does not "
                                     "match its checksum; rerun its job to restore it",
                                     path.string()),
                         ExitCode::environment);
    try {
        const Json root = Json::parse(*text);
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
                                   .reference_id = entry.at("reference_id").get<std::string>(),
                                   .sample = sample_of(entry)});
        index.uncertain = uncertain_of(root);
        if (root.contains("adaptive"))
            for (const Json& axis : root.at("adaptive"))
                index.adaptive.push_back(adaptive_axis_of(axis));
        return index;
    } catch (const JsonError& error) {
        throw UsageError(path.string() + " is not a plan: " + error.what(), ExitCode::environment);
    }
}

} // namespace shearwake::storage
