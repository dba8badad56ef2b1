// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/study.hpp"

#include "base/units.hpp"
#include "problem/load/load.hpp"

#include <algorithm>
#include <utility>

namespace shearwake::optimise {
namespace {

Json settings_json(const std::vector<Setting>& settings) {
    Json list = Json::array();
    for (const Setting& setting : settings)
        std::visit([&](const auto& value) { list.push_back({setting.key, value}); }, setting.value);
    return list;
}

Json json_of(const OptimiseOptions& o) {
    Json over = Json::array();
    for (const OptimisedPart part : o.over)
        over.push_back(name_in_text(part));
    return {{"maximise", o.maximise},
            {"over", std::move(over)},
            {"knot_s", o.knot_s},
            {"strengths", o.strengths},
            {"uniformity", o.uniformity},
            {"starts", o.starts},
            {"factor_at_most", o.factor_at_most},
            {"rounds", o.rounds},
            {"am_frequencies_Hz", o.am_frequencies_Hz},
            {"sm_frequencies_Hz", o.sm_frequencies_Hz},
            {"sm_deviations_m_s", o.sm_deviations_m_s},
            {"robust_to", o.robust_to},
            {"robust_strengths", o.robust_strengths},
            {"update_rate_Hz", o.update_rate_Hz},
            {"bits", o.bits}};
}

/// A case of the same job in another tissue, by its number.
Json other_tissues(const Study& study, const Case& c) {
    Json found = Json::array();
    for (std::size_t j = 0; j < study.cases.size(); ++j) {
        const Case& other = study.cases[j].planned.physics;
        Case same = c;
        same.scene.medium = other.scene.medium;
        if (!(c == other) && same == other) found.push_back(j);
    }
    return found;
}

const Travel* travel_of(const Case& c) {
    for (const Mover& mover : c.scene.load.modulation.trajectory.parts)
        if (const auto* travel = std::get_if<Travel>(&mover)) return travel;
    return nullptr;
}

/// A walk over the fields of a shape that collects its lengths as keys of a job.
struct LengthKeys {
    Json values = Json::object();

    void operator()(Vec2 point_m, const Field& field) {
        values[field.key] = {1e3 * point_m.x, 1e3 * point_m.y};
    }
    void operator()(double value, const Field& field) {
        if (std::string_view(field.key).ends_with("_mm")) values[field.key] = 1e3 * value;
    }
    void operator()(const std::vector<Vec2>& points_m, const Field& field) {
        for (const Vec2& point_m : points_m)
            values[field.key].push_back({1e3 * point_m.x, 1e3 * point_m.y});
    }
    void operator()(const auto&, const Field&) {}
    void key(const Field&) {}
};

/// The keys of [load.modulation.path] that have changed, and whether a polyline is closed.
Json changed_path(const Curve& before, const Curve& after) {
    LengthKeys old, keys;
    std::visit([&](const auto& shape) { walk_fields(old, shape); }, before.shape);
    std::visit([&](const auto& shape) { walk_fields(keys, shape); }, after.shape);
    Json changed = Json::object();
    for (const auto& [key, value] : keys.values.items())
        if (!old.values.contains(key) || old.values.at(key) != value) changed[key] = value;
    if (const auto* polyline = std::get_if<Polyline>(&after.shape))
        changed["closed"] = polyline->ends() == Ends::closed;
    return changed;
}

} // namespace

std::vector<OptimisedCase> optimised_cases(const Plan& plan, const OptimiseOptions& options) {
    std::vector<OptimisedCase> cases;
    for (const PlannedCase& planned : plan.cases) {
        if (planned.is_reference) continue;
        const Knots knots = knots_of(planned.physics, options.knot_s);
        require_optimisable(planned.physics, planned.id, knots, options);
        cases.push_back({planned, knots});
    }
    return cases;
}

Json description(const Study& study, int ranks) {
    const Plan& plan = study.job.plan;
    Json cases = Json::array(), ids = Json::array();
    for (const OptimisedCase& c : study.cases) {
        const Case& physics = c.planned.physics;
        cases.push_back({{"id", c.planned.id},
                         {"settings", settings_json(c.planned.settings)},
                         {"knots", c.knots.count},
                         {"interval_s", c.knots.interval_s},
                         {"repeat", c.knots.repeat},
                         {"window_s", window_s(physics)},
                         {"speed_m_s", has_speed(physics) ? Json(speed_m_s(physics)) : Json()},
                         {"other_tissues", other_tissues(study, physics)}});
    }
    for (const PlannedCase& c : plan.cases)
        ids.push_back(c.id);
    return {{"name", plan.name},
            {"title", plan.title},
            {"swept_keys", plan.swept_keys},
            {"job", study.job.text},
            {"folder", study.folder.root.string()},
            {"ranks", ranks},
            {"quiet", study.run.quiet},
            {"next", schedule::reduce_command_line(study.folder)},
            {"options", json_of(study.options)},
            {"cases", std::move(cases)},
            {"ids", std::move(ids)}};
}

std::optional<Case> case_of(const Study& study, const Json& variant) {
    std::optional<Case> c = study.cases.at(variant.at("case").get<std::size_t>()).planned.physics;
    if (const Json* motion = variant.find("motion"))
        c = with_motion(*c, {.size = motion->at("size").get<double>(),
                             .speed = motion->at("speed").get<double>(),
                             .periods = motion->at("periods").get<int>(),
                             .sine = motion->at("sine").get<double>(),
                             .cosine = motion->at("cosine").get<double>()});
    if (!c) return std::nullopt;
    if (const Json* envelope = variant.find("envelope"))
        c->scene.load.modulation.envelope.gains = {
            SampledGain{.values = envelope->at("values").get<std::vector<double>>(),
                        .interval_s = envelope->at("interval_s").get<double>(),
                        .repeat = envelope->at("repeat").get<bool>()}};
    if (variant.find("readings_only")) c = without_record(*c);
    if (const Json* sm = variant.find("sm")) {
        c = with_oscillating_speed(*c, sm->at("frequency_Hz").get<double>(),
                                   sm->at("deviation_m_s").get<double>(),
                                   sm->at("phase_rad").get<double>());
        if (!can_be_computed(*c)) return std::nullopt;
    }
    if (const Json* difference = variant.find("difference"))
        c = with_difference(*c, {.c_s = difference->at("c_s").get<double>(),
                                 .viscosity = difference->at("viscosity").get<double>(),
                                 .speed = difference->at("speed").get<double>()});
    return c;
}

Json describe(const Study& study, const Json& variant) {
    const std::optional<Case> c = case_of(study, variant);
    if (!c) return nullptr;
    Json described = {{"id", case_id(*c)}};
    const Travel* travel = travel_of(*c);
    if (!travel) return described;
    if (const auto* constant = std::get_if<ConstantSpeed>(&travel->motion))
        described["speed_m_s"] = constant->speed_m_s;
    if (const auto* swings = std::get_if<OscillatingSpeed>(&travel->motion))
        described.update({{"speed_m_s", swings->mean_m_s},
                          {"speed_deviation_m_s", swings->deviation_m_s},
                          {"sm_frequency_Hz", swings->frequency_Hz},
                          {"sm_phase_deg", to_degrees(swings->phase_rad)}});
    const Case& base = study.cases.at(variant.at("case").get<std::size_t>()).planned.physics;
    described["path"] = changed_path(travel_of(base)->path, travel->path);
    return described;
}

Json positions(const Study& study, const Json& request) {
    const Case c = case_of(study, request).value();
    Json places = Json::array();
    for (const double t_s : request.at("times_s").get<std::vector<double>>()) {
        const Vec2 place = position(c.scene.load.modulation.trajectory, t_s);
        places.push_back({place.x, place.y});
    }
    return places;
}

} // namespace shearwake::optimise
