// SPDX-License-Identifier: BSD-3-Clause
#include "studies/converge/convergence.hpp"

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "engines/registry/make_engine.hpp"
#include "measures/measure_table.hpp"
#include "measures/surface_sums.hpp"
#include "storage/journal/plan_file.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace shearwake::converge {
namespace {

/// Measures are sums over cells, of which the edges of the focal disc cut some, and over frames by
/// the trapezoidal rule. Both are of second order, whatever that of the field is.
constexpr double order_of_sums = 2.0;

/// At the faces of bodies, cells contain the mean of two materials, which is of first order.
double order_in_spacing(const Case& c) {
    return varies_laterally(c.scene.medium) ? 1.0 : order_of_sums;
}

Refinement half_the_spacing(const Case& c) {
    Refinement r{.name = "spacing", .change = "", .physics = c, .order = order_in_spacing(c)};
    Domain& d = r.physics.domain;
    d.nx *= 2;
    d.ny *= 2;
    d.spacing_m *= 0.5;
    // Without a sponge, a region ends half a cell before the edges of the domain.
    if (!c.measure.region_m.empty())
        r.physics.measure.region_m = measures::measured_outline(c.domain, c.measure);
    r.change = fmt::format("half the spacing, {:.4g} mm", 1e3 * d.spacing_m);
    return r;
}

Refinement twice_the_domain(const Case& c) {
    Refinement r{.name = "domain", .change = "", .physics = c, .order = std::nullopt};
    Domain& d = r.physics.domain;
    d.nx *= 2;
    d.ny *= 2;
    // The larger domain is measured where the original one is.
    r.physics.measure.region_m = measures::measured_outline(c.domain, c.measure);
    r.change = fmt::format("twice the domain, {:.4g} x {:.4g} mm", 1e3 * d.extent_x_m(),
                           1e3 * d.extent_y_m());
    return r;
}

Refinement refine_time_step(const Case& c) {
    const engines::StepRefinement step = engines::make_engine(c.solver)->refine_time_step(c);
    Refinement r{.name = "time",
                 .change = step.change + (step.change.empty() ? "" : ", and ") +
                           "half the frame interval",
                 .physics = c,
                 .ratio = step.ratio,
                 .order = order_of_sums};
    r.physics.solver = step.options;
    r.physics.time.frames *= 2;
    r.physics.time.interval_s *= 0.5;
    return r;
}

} // namespace

Case without_fields(Case c) {
    c.record.frames = false;
    c.record.volumes_s.clear();
    c.record.volume_fields.clear();
    return c;
}

std::vector<Refinement> refinements(const Case& c) {
    const Case base = without_fields(c);
    return {half_the_spacing(base), refine_time_step(base), twice_the_domain(base)};
}

namespace {

constexpr const char* refinement_key = "converge.refinement";

const PlannedCase& case_of(const Plan& plan, const std::string& id) {
    std::vector<std::string> ids;
    for (const PlannedCase& c : plan.cases) {
        if (c.id == id) return c;
        ids.push_back(c.id);
    }
    const auto meant = nearest(id, ids);
    throw UsageError(
        fmt::format("--only {}: no such case{}; shearwake plan lists the ids of all cases", id,
                    meant ? "; did you mean " + *meant + "?" : ""));
}

/// At most `count` of the ordinary cases, from the first to the last.
std::vector<const PlannedCase*> spread(const Plan& plan, std::size_t count) {
    std::vector<const PlannedCase*> ordinary, chosen;
    for (const PlannedCase& c : plan.cases)
        if (!c.is_reference) ordinary.push_back(&c);
    count = std::min(count, ordinary.size());
    for (std::size_t i = 0; i < count; ++i)
        chosen.push_back(ordinary[count == 1 ? 0 : i * (ordinary.size() - 1) / (count - 1)]);
    return chosen;
}

std::vector<const PlannedCase*> selection(const Plan& plan, std::span<const std::string> only,
                                          std::size_t count) {
    std::vector<const PlannedCase*> chosen;
    for (const std::string& id : only)
        chosen.push_back(&case_of(plan, id));
    if (only.empty()) chosen = spread(plan, count);
    for (std::size_t i = 0, n = chosen.size(); i < n; ++i) {
        if (chosen[i]->reference_id.empty()) continue;
        const PlannedCase* reference = &case_of(plan, chosen[i]->reference_id);
        if (std::ranges::find(chosen, reference) == chosen.end()) chosen.push_back(reference);
    }
    return chosen;
}

} // namespace

RefinedPlan refined_plan(const Plan& plan, std::span<const std::string> only, std::size_t count) {
    RefinedPlan found;
    found.plan = {.name = plan.name,
                  .title = "Convergence of " + plan.name,
                  .swept_keys = plan.swept_keys,
                  .table = {.x = "", .series = {}},
                  .cases = {}};
    found.plan.swept_keys.emplace_back(refinement_key);
    std::map<std::string, std::string> references; // id of the case and refinement -> refined id
    for (const PlannedCase* planned : selection(plan, only, count)) {
        StudiedCase studied{.planned = planned,
                            .base_id = case_id(without_fields(planned->physics)),
                            .refinements = refinements(planned->physics),
                            .refined_ids = {}};
        const auto add = [&](const std::string& refinement, const Case& physics) {
            const std::string id = case_id(physics);
            references[planned->id + refinement] = id;
            const bool known = std::ranges::any_of(
                found.plan.cases, [&](const PlannedCase& c) { return c.id == id; });
            if (known) return id;
            PlannedCase refined{.id = id, .physics = physics, .settings = planned->settings};
            refined.settings.push_back({refinement_key, refinement});
            found.plan.cases.push_back(std::move(refined));
            return id;
        };
        add("none", without_fields(planned->physics));
        for (const Refinement& r : studied.refinements)
            studied.refined_ids.push_back(add(r.name, r.physics));
        found.cases.push_back(std::move(studied));
    }
    // Ratios to the reference are formed with the same refinement of both cases.
    const auto refer = [&](const std::string& id, const std::string& to) {
        for (PlannedCase& c : found.plan.cases)
            if (c.id == id) c.reference_id = to;
    };
    for (const StudiedCase& studied : found.cases) {
        const std::string& reference = studied.planned->reference_id;
        if (reference.empty()) continue;
        refer(studied.base_id, references.at(reference + "none"));
        for (std::size_t i = 0; i < studied.refinements.size(); ++i)
            refer(studied.refined_ids[i], references.at(reference + studied.refinements[i].name));
    }
    return found;
}

std::string json_text(const RefinedPlan& refined) {
    Json cases = Json::array(), headlines = Json::array();
    for (const measures::Measure& measure : measures::all_measures())
        if (measure.shown == measures::Shown::headlines && !measures::counts_samples(measure.name))
            headlines.push_back(measure.name);
    for (const StudiedCase& c : refined.cases) {
        Json refinements = Json::array();
        for (std::size_t i = 0; i < c.refinements.size(); ++i) {
            const Refinement& r = c.refinements[i];
            refinements.push_back({{"name", r.name},
                                   {"change", r.change},
                                   {"id", c.refined_ids[i]},
                                   {"ratio", r.ratio},
                                   {"order", r.order ? Json(*r.order) : nullptr}});
        }
        cases.push_back({{"id", c.planned->id},
                         {"settings", storage::settings_json(c.planned->settings)},
                         {"is_reference", c.planned->is_reference},
                         {"base", c.base_id},
                         {"refinements", refinements}});
    }
    return Json({{"schema", 1},
                 {"job", refined.plan.name},
                 {"title", refined.plan.title},
                 {"headlines", headlines},
                 {"cases", cases}})
               .dump(1) +
           "\n";
}

} // namespace shearwake::converge
