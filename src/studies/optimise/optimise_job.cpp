// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.hpp"
#include "config/document/tree.hpp"
#include "config/sweep/override.hpp"
#include "schedule/run/job_source.hpp"
#include "studies/optimise/optimise_table.hpp"
#include "studies/optimise/search/waveform.hpp"

#include <fmt/format.h>
#include <numbers>

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
            if (const auto* integer = std::get_if<std::int64_t>(&of.value))
                return factor * static_cast<double>(*integer);
            return factor * std::get<double>(of.value);
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

/// A path that is larger or smaller.
void set_path(JobTree& job, const Curve& curve) {
    const std::string path = "load.modulation.path";
    std::visit(
        overloaded{[&](const Line& line) {
                       job.set(path + ".from_mm", point_text(line.from_m));
                       job.set(path + ".to_mm", point_text(line.to_m));
                   },
                   [&](const Arc& arc) { job.set(path + ".radius_mm", exact(1e3 * arc.radius_m)); },
                   [&](const Polyline& polyline) {
                       for (const char* key : {"corners_mm", "sides", "side_mm", "radius_mm",
                                               "center_mm", "start_deg", "file"})
                           job.remove(path, key);
                       std::string points;
                       for (const Vec2& point_m : polyline.points_m())
                           points += (points.empty() ? "" : ", ") + point_text(point_m);
                       job.set(path + ".shape", "\"polyline\"");
                       job.set(path + ".points_mm", "[" + points + "]");
                       job.set(path + ".closed",
                               polyline.ends() == Ends::closed ? "true" : "false");
                   },
                   [&](const Lissajous& lissajous) {
                       job.set(path + ".amplitudes_mm", point_text(lissajous.shape().amplitudes_m));
                   }},
        curve.shape);
}

void set_motion(JobTree& job, const MovedCase& moved) {
    if (moved.change == MotionChange{}) return;
    job.remove("load.modulation", "draw_frequency_Hz");
    for (const Mover& mover : moved.physics.scene().load.modulation.trajectory.parts) {
        const auto* travel = std::get_if<Travel>(&mover);
        if (!travel) continue;
        if (moved.change.size != 1.0) set_path(job, travel->path);
        if (const auto* constant = std::get_if<ConstantSpeed>(&travel->motion))
            job.set("load.modulation.speed_m_s", exact(constant->speed_m_s));
        const auto* swing = std::get_if<OscillatingSpeed>(&travel->motion);
        if (!swing) continue;
        job.set("load.modulation.kind", "\"SM-STM\"");
        job.set("load.modulation.speed_m_s", exact(swing->mean_m_s));
        job.set("load.modulation.speed_deviation_m_s", exact(swing->deviation_m_s));
        job.set("load.modulation.sm_frequency_Hz", exact(swing->frequency_Hz));
        job.set("load.modulation.sm_phase_deg", exact(180.0 / std::numbers::pi * swing->phase_rad));
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
    set_motion(job, moved);
    job.set("load.modulation.envelope",
            fmt::format("[{{ shape = \"samples\", interval_us = {}, repeat = {}, values = {} }}]",
                        exact(1e6 * envelope.interval_s), envelope.repeat ? "true" : "false",
                        list_text(envelope.values)));
    return "# Written by `shearwake optimise`; `shearwake run` reproduces the case.\n" + job.text();
}

} // namespace shearwake::optimise
