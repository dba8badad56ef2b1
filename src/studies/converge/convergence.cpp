// SPDX-License-Identifier: BSD-3-Clause
#include "studies/converge/convergence.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "engines/registry/make_engine.hpp"
#include "measures/measure_table.hpp"
#include "measures/surface_sums.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>

namespace shearwake::converge {
namespace {

double value_in(const std::map<std::string, Values>& all, const std::string& id,
                const std::string& column) {
    const auto row = all.find(id);
    if (row == all.end()) return not_a_number;
    const auto cell = row->second.find(column);
    return cell == row->second.end() ? not_a_number : cell->second;
}

/// Errors of a single frame vary irregularly with the position of the samples, and changes may be
/// small by chance. Roache's grid convergence index (1994) has a factor of 1.25 to 3 for this.
constexpr double safety_factor = 1.5;

ColumnChange change_of(const StudiedCase& studied, const std::string& column, double value,
                       const std::map<std::string, Values>& values) {
    ColumnChange change{.column = column, .value = value, .changes = {}};
    for (std::size_t i = 0; i < studied.refinements.size(); ++i) {
        const double difference = value_in(values, studied.refined_ids[i], column) - value;
        change.changes.push_back(difference);
        change.error += safety_factor * estimated_error(difference, studied.refinements[i]);
    }
    return change;
}

/// A peak is the largest of all samples: both grids may miss it by the same amount.
bool has_estimate(const std::string& column) {
    return !measures::counts_samples(column) && !column.starts_with("peak_um") &&
           !column.starts_with("felt_peak_");
}

/// Errors of levels are those of the amplitude, which do not depend on where 0 dB is.
double relative_error(const ColumnChange& change) {
    return change.column.ends_with("_dB") ? std::pow(10.0, change.error / 20.0) - 1.0
                                          : change.error / std::abs(change.value);
}

std::string signed_number(double value) {
    return std::isnan(value) ? "" : fmt::format("{:+.2g}", value);
}

std::string order_words(const Refinement& r) {
    return r.order ? fmt::format("order {:g}", *r.order) : "no order: the change is the estimate";
}

} // namespace

std::vector<CaseChange> changes_of(const RefinedPlan& refined,
                                   const std::map<std::string, Values>& values) {
    std::vector<CaseChange> all;
    for (const StudiedCase& studied : refined.cases) {
        CaseChange change{.studied = &studied, .columns = {}};
        change.is_complete = values.contains(studied.base_id) &&
                             std::ranges::all_of(studied.refined_ids, [&](const std::string& id) {
                                 return values.contains(id);
                             });
        if (const auto base = values.find(studied.base_id); base != values.end())
            for (const auto& [column, value] : base->second)
                if (!std::isnan(value) && has_estimate(column))
                    change.columns.push_back(change_of(studied, column, value, values));
        all.push_back(std::move(change));
    }
    return all;
}

std::string json_text(const std::string& job, const std::vector<CaseChange>& changes) {
    using nlohmann::ordered_json;
    ordered_json cases = ordered_json::array();
    for (const CaseChange& c : changes) {
        ordered_json refinements = ordered_json::array(), columns = ordered_json::object(),
                     settings = ordered_json::object();
        for (std::size_t i = 0; i < c.studied->refinements.size(); ++i) {
            const Refinement& r = c.studied->refinements[i];
            refinements.push_back({{"name", r.name},
                                   {"change", r.change},
                                   {"id", c.studied->refined_ids[i]},
                                   {"ratio", r.ratio},
                                   {"order", r.order ? ordered_json(*r.order) : nullptr}});
        }
        for (const ColumnChange& column : c.columns) {
            ordered_json by_name = ordered_json::object();
            for (std::size_t i = 0; i < column.changes.size(); ++i)
                by_name[c.studied->refinements[i].name] = column.changes[i]; // NaN: null
            columns[column.column] = {
                {"value", column.value}, {"changes", by_name}, {"error", column.error}};
        }
        for (const Setting& s : c.studied->planned->settings)
            std::visit([&](const auto& v) { settings[s.key] = v; }, s.value);
        cases.push_back({{"id", c.studied->planned->id},
                         {"settings", settings},
                         {"is_reference", c.studied->planned->is_reference},
                         {"complete", c.is_complete},
                         {"valid", c.is_valid},
                         {"refinements", refinements},
                         {"columns", columns}});
    }
    return ordered_json({{"schema", 1}, {"job", job}, {"cases", cases}}).dump(1) + "\n";
}

std::string markdown_text(const std::vector<CaseChange>& changes,
                          const std::vector<std::string>& shown) {
    std::string text;
    for (const CaseChange& c : changes) {
        const PlannedCase& planned = *c.studied->planned;
        text +=
            fmt::format("{}## {}{}{}{}{}\n\n", text.empty() ? "" : "\n", planned.id,
                        planned.is_reference ? ", reference" : "", c.is_valid ? "" : ", not valid",
                        planned.settings.empty() ? "" : ": ", settings_text(planned.settings));
        for (const Refinement& r : c.studied->refinements)
            text += fmt::format("* {}: {} ({})\n", r.name, r.change, order_words(r));
        text += "\n| column | value |";
        std::string rule = "| --- | ---: |";
        for (const Refinement& r : c.studied->refinements) {
            text += fmt::format(" change: {} |", r.name);
            rule += " ---: |";
        }
        text += " estimated error | relative |\n" + rule + " ---: | ---: |\n";
        for (const std::string& name : shown)
            for (const ColumnChange& column : c.columns) {
                if (column.column != name) continue;
                text += fmt::format("| {} | {:.5g} |", name, column.value);
                for (const double change : column.changes)
                    text += " " + signed_number(change) + " |";
                const bool known = !std::isnan(column.error);
                text +=
                    fmt::format(" {} | {} |\n", known ? fmt::format("{:.2g}", column.error) : "",
                                known && (column.value != 0.0 || column.column.ends_with("_dB"))
                                    ? fmt::format("{:.2g} %", 100.0 * relative_error(column))
                                    : "");
            }
    }
    return text;
}

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

Refinement half_the_step(const Case& c) {
    const engines::StepRefinement step = engines::make_engine(c.solver)->half_the_step(c);
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
    return {half_the_spacing(base), half_the_step(base), twice_the_domain(base)};
}

double estimated_error(double change, const Refinement& refinement) {
    if (!refinement.order) return std::abs(change);
    const double power = std::pow(refinement.ratio, *refinement.order);
    return std::abs(change) * power / (power - 1.0);
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

} // namespace shearwake::converge
