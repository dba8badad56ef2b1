// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.hpp"
#include "base/units.hpp"
#include "config/document/tree.hpp"
#include "config/sweep/override.hpp"
#include "schedule/run/run.hpp"
#include "studies/optimise/optimise_study.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::optimise {
namespace {

std::string list_text(const std::vector<double>& values) {
    std::string text;
    for (const double value : values)
        text += (text.empty() ? "" : ", ") + exact(value);
    return "[" + text + "]";
}

std::string point_text(Vec2 point_m) {
    return list_text({1e3 * point_m.x, 1e3 * point_m.y});
}

/// The job as a tree, of which single values are changed.
class JobTree {
public:
    explicit JobTree(const config::Job& job)
        : root_(config::parse_toml(job.text, job.plan.name, diagnostics_)) {}

    void set(const std::string& key, const std::string& value) {
        root_ = config::with_override(root_, {key, value}, diagnostics_);
    }
    void remove(const std::string& key) { root_ = config::without(root_, key); }
    void remove(const std::string& table, const std::string& key) {
        const config::Path path = config::split_path(table).value();
        const config::NodePtr node = config::find(root_, path);
        std::string problem;
        if (node) root_ = config::with(root_, path, config::without(node, key), node->at, problem);
    }
    /// Multiplies a number or the numbers of a list, if the key exists.
    void scale(const std::string& key, double factor) {
        const config::NodePtr node = config::find(root_, config::split_path(key).value());
        if (!node || factor == 1.0) return;
        const auto number = [&](const config::Node& of) {
            return factor * config::as_number(of).value();
        };
        const auto* list = std::get_if<config::ListNode>(&node->value);
        if (!list) return set(key, exact(number(*node)));
        std::vector<double> values;
        for (const config::NodePtr& entry : *list)
            values.push_back(number(*entry));
        set(key, list_text(values));
    }

    /// As TOML: first the keys of the root, then its tables.
    std::string text() const {
        std::string keys, tables;
        for (const config::Entry& entry : std::get<config::TableNode>(root_->value).entries) {
            const auto* table = std::get_if<config::TableNode>(&entry.value->value);
            if (!table) {
                keys += fmt::format("{} = {}\n", entry.key, config::render(*entry.value));
                continue;
            }
            tables += fmt::format("\n[{}]\n", entry.key);
            for (const config::Entry& of : table->entries)
                tables += fmt::format("{} = {}\n", of.key, config::render(*of.value));
        }
        return keys + tables;
    }

private:
    config::DiagnosticList diagnostics_;
    config::NodePtr root_;
};

/// A walk over the fields of a shape that collects its lengths as keys of a job.
struct LengthKeys {
    std::vector<std::pair<std::string, std::string>> values;

    void operator()(Vec2 point_m, const Field& field) {
        values.emplace_back(field.key, point_text(point_m));
    }
    void operator()(double value, const Field& field) {
        if (std::string_view(field.key).ends_with("_mm"))
            values.emplace_back(field.key, exact(1e3 * value));
    }
    void operator()(const std::vector<Vec2>& points_m, const Field& field) {
        std::string points;
        for (const Vec2& point_m : points_m)
            points += (points.empty() ? "" : ", ") + point_text(point_m);
        values.emplace_back(field.key, "[" + points + "]");
    }
    void operator()(const auto&, const Field&) {}
    void key(const Field&) {}
};

LengthKeys lengths_of(const Curve& curve) {
    LengthKeys keys;
    std::visit([&](const auto& shape) { walk_fields(keys, shape); }, curve.shape);
    return keys;
}

/// A path that is larger or smaller.
void set_path(JobTree& job, const Curve& before, const Curve& after) {
    const std::string path = "load.modulation.path";
    if (const auto* polyline = std::get_if<Polyline>(&after.shape)) {
        for (const char* key : {"corners_mm", "sides", "side_mm", "radius_mm", "center_mm",
                                "start_deg", "file"}) // of a polygon or a file of points
            job.remove(path, key);
        job.set(path + ".shape", "\"polyline\"");
        job.set(path + ".closed", polyline->ends() == Ends::closed ? "true" : "false");
    }
    const LengthKeys old = lengths_of(before);
    for (const auto& length : lengths_of(after).values)
        if (std::ranges::find(old.values, length) == old.values.end())
            job.set(path + "." + length.first, length.second);
}

void set_motion(JobTree& job, const Case& base, const MovedCase& moved) {
    if (moved.change == MotionChange{}) return;
    job.remove("load.modulation", "draw_frequency_Hz");
    const std::vector<Mover>& parts = moved.physics.scene.load.modulation.trajectory.parts;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const auto* travel = std::get_if<Travel>(&parts[i]);
        if (!travel) continue;
        const Mover& before = base.scene.load.modulation.trajectory.parts[i];
        if (moved.change.size != 1.0) set_path(job, std::get<Travel>(before).path, travel->path);
        const auto set = [&](const char* key, double value) {
            job.set(std::string("load.modulation.") + key, exact(value));
        };
        const auto set_oscillating = [&](const OscillatingSpeed& speed) {
            job.set("load.modulation.kind", "\"SM-STM\"");
            set("speed_m_s", speed.mean_m_s);
            set("speed_deviation_m_s", speed.deviation_m_s);
            set("sm_frequency_Hz", speed.frequency_Hz);
            set("sm_phase_deg", to_degrees(speed.phase_rad));
        };
        std::visit(
            overloaded{[&](const ConstantSpeed& constant) { set("speed_m_s", constant.speed_m_s); },
                       set_oscillating, [](const Rests&) {}},
            travel->motion);
    }
    const double factor = moved.change.size / moved.change.speed;
    for (const char* key : {"time.duration_ms", "time.output_interval_us", "measure.at_ms",
                            "measure.settled_after_ms", "record.snapshots_ms"})
        job.scale(key, factor);
}

} // namespace

std::string job_of_optimum(const Study& study, const OptimisedCase& of, const MovedCase& moved,
                           const SampledGain& envelope) {
    JobTree job(study.job);
    for (const char* table : {"sweep", "table", "uncertain"})
        job.remove(table);
    for (const config::Override& changed : schedule::parse_overrides(study.run.overrides))
        job.set(changed.key, changed.value);
    for (const Setting& setting : of.base.settings)
        job.set(setting.key, std::visit(overloaded{[](double number) { return exact(number); },
                                                   [](const std::string& text) { return text; }},
                                        setting.value));
    job.remove("optimise");
    job.set("job.name", "\"" + study.job.plan.name + "-optimum\"");
    set_motion(job, of.base.physics, moved);
    job.set("load.modulation.envelope",
            fmt::format("[{{ shape = \"samples\", interval_us = {}, repeat = {}, values = {} }}]",
                        exact(1e6 * envelope.interval_s), envelope.repeat ? "true" : "false",
                        list_text(envelope.values)));
    return "# Written by `shearwake optimise`; `shearwake run` reproduces the case.\n" + job.text();
}

} // namespace shearwake::optimise
