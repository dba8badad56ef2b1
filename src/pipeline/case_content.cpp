// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/case_content.hpp"

#include "measures/measure_table.hpp"
#include "measures/spectrum.hpp"
#include "pipeline/provenance.hpp"
#include "problem/load/drawn_shape.hpp"
#include "storage/case_file/variable_group.hpp"
#include "storage/case_file/warnings_text.hpp"
#include "storage/hdf5/h5.hpp"
#include "storage/journal/plan_file.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace shearwake::pipeline {
namespace {

std::vector<double> over_time(const Case& c, const auto& value) {
    std::vector<double> values;
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
        values.push_back(value(c.time.frame_s(n)));
    return values;
}

Variable series(const std::vector<measures::DepthSeries>& depths,
                const measures::FrameMeasure& measure) {
    Variable variable{.name = measure.name,
                      .dimensions = {"depth", "time"},
                      .values = {},
                      .units = measure.unit,
                      .long_name = measure.meaning,
                      .note = ""};
    for (const measures::DepthSeries& depth : depths)
        for (const measures::SurfaceSums& sums : depth.frames)
            variable.values.push_back(measure.value(sums));
    return variable;
}

std::vector<Variable> root_series(const Case& c, const std::vector<measures::DepthSeries>& depths) {
    const Trajectory& trajectory = c.scene().load.modulation.trajectory;
    Load averaged = c.scene().load; // frames do not resolve the carrier
    averaged.carrier = AveragedCarrier{};
    const auto time = over_time(c, [](double t) { return t; });
    std::vector<Variable> variables = {
        {"time", {"time"}, time, "s", "time since the load began", ""},
        {"depth", {"depth"}, c.measure.depths_m, "m", "depth below the skin surface", ""},
        {"focus_x",
         {"time"},
         over_time(c, [&](double t) { return position(trajectory, t).x; }),
         "m",
         "position of the focus along x",
         ""},
        {"focus_y",
         {"time"},
         over_time(c, [&](double t) { return position(trajectory, t).y; }),
         "m",
         "position of the focus along y",
         ""},
        {"force",
         {"time"},
         forces_N(averaged, time),
         "N",
         "force of the whole footprint, averaged over the carrier's cycle",
         ""},
    };
    for (const measures::FrameMeasure& measure : measures::frame_measures())
        variables.push_back(series(depths, measure));
    return variables;
}

VariableGroup trace_group(const Case& c, const std::vector<measures::TraceSeries>& traces) {
    const auto frequencies = measures::trace_frequencies_Hz(c.time);
    std::vector<double> number, x, y, u, amplitude;
    for (const measures::TraceSeries& trace : traces) {
        number.push_back(static_cast<double>(number.size()));
        x.push_back(trace.at_m.x);
        y.push_back(trace.at_m.y);
        u.insert(u.end(), trace.u_m.begin(), trace.u_m.end());
        const auto spectrum =
            measures::amplitude_spectrum(trace.u_m, c.time.interval_s, frequencies);
        amplitude.insert(amplitude.end(), spectrum.begin(), spectrum.end());
    }
    return {
        "traces",
        {{"trace", {"trace"}, number, "1", "number of the trace point", ""},
         {"time",
          {"time"},
          over_time(c, [](double t) { return t; }),
          "s",
          "time since the load began",
          ""},
         {"frequency", {"frequency"}, frequencies, "Hz", "frequency", ""},
         {"x", {"trace"}, x, "m", "position of the trace point along x", ""},
         {"y", {"trace"}, y, "m", "position of the trace point along y", ""},
         {"u_z", {"trace", "time"}, u, "m", "normal displacement, positive into the tissue", ""},
         {"amplitude",
          {"trace", "frequency"},
          amplitude,
          "m",
          "one-sided amplitude spectrum of u_z over the run (its mean at 0 Hz)",
          ""}}};
}

VariableGroup mean_group(const Case& c, const std::vector<double>& mean_u2) {
    const Domain& d = c.domain;
    std::vector<double> number, line, x, y;
    const auto lines = drawn_shape(c.scene().load.modulation, d.spacing_m);
    for (std::size_t l = 0; l < lines.size(); ++l)
        for (const Vec2 point : lines[l]) {
            number.push_back(static_cast<double>(number.size()));
            line.push_back(static_cast<double>(l));
            x.push_back(point.x);
            y.push_back(point.y);
        }
    return {
        "mean",
        {{"x", {"x"}, storage::coordinate(d.nx, [&](auto i) { return d.x_m(i); }), "m", "x", ""},
         {"y", {"y"}, storage::coordinate(d.ny, [&](auto j) { return d.y_m(j); }), "m", "y", ""},
         {"u_z_squared",
          {"x", "y"},
          mean_u2,
          "m2",
          "time mean of u_z^2 over whole modulation periods",
          ""},
         {"point", {"point"}, number, "1", "number of the point of the drawn shape", ""},
         {"drawn_line",
          {"point"},
          line,
          "1",
          "number of the line of the drawn shape, one per focus",
          ""},
         {"drawn_x", {"point"}, x, "m", "x of the drawn shape", ""},
         {"drawn_y", {"point"}, y, "m", "y of the drawn shape", ""}}};
}

} // namespace

std::vector<VariableGroup> case_content(const Case& c,
                                        const std::vector<measures::DepthSeries>& depths,
                                        const std::vector<measures::TraceSeries>& traces,
                                        const std::optional<measures::MachFit>& mach,
                                        const std::vector<double>& mean_u2) {
    std::vector<VariableGroup> groups = {{"", root_series(c, depths)}};
    add_columns(measures::summarise(c, depths, traces, mach, mean_u2), groups.front());
    if (!traces.empty()) groups.push_back(trace_group(c, traces));
    if (!mean_u2.empty()) groups.push_back(mean_group(c, mean_u2));
    return groups;
}

std::vector<measures::Column> energy_columns(const engines::SolverReport& solver) {
    if (!solver.period_energy) return {};
    const engines::PeriodEnergy& energy = *solver.period_energy;
    return {measures::column_of("period_work_uJ", 1e6 * energy.work_J, {}),
            measures::column_of("period_absorbed_uJ", 1e6 * energy.absorbed_in_layers_J, {}),
            measures::column_of("period_radiated_uJ", 1e6 * energy.radiated_J, {})};
}

void add_columns(const std::vector<measures::Column>& columns, VariableGroup& group) {
    for (const measures::Column& column : columns)
        group.variables.push_back({.name = column.name,
                                   .dimensions = {},
                                   .values = {column.value},
                                   .units = column.unit,
                                   .long_name = column.long_name,
                                   .note = column.note});
}

std::string columns_in_samples(const VariableGroup& root) {
    std::vector<std::string> names;
    for (const Variable& variable : root.variables)
        if (measures::counts_samples(variable.name)) names.push_back(variable.name);
    return fmt::format("{}", fmt::join(names, " "));
}

VariableGroup sensor_group(const StudyData& study,
                           const std::vector<engines::SensorSeries>& sensors) {
    VariableGroup group{.name = "sensor", .variables = {}};
    if (sensors.empty()) return group;
    const auto count = [](std::ptrdiff_t n) { return static_cast<std::size_t>(n); };
    std::vector<double> samples_s(count(sensors.front().samples)), numbers(study.sensors.size());
    for (std::size_t n = 0; n < samples_s.size(); ++n)
        samples_s[n] =
            study.time_step_s * (static_cast<double>(n) + static_cast<double>(study.sensor_start));
    std::iota(numbers.begin(), numbers.end(), 0.0);
    group.variables.push_back({.name = "time",
                               .dimensions = {"time"},
                               .values = samples_s,
                               .units = "s",
                               .long_name = "end of the step; velocities are half a step earlier",
                               .note = ""});
    group.variables.push_back({.name = "node",
                               .dimensions = {"node"},
                               .values = numbers,
                               .units = "1",
                               .long_name = "node of the sensor",
                               .note = ""});
    for (const std::size_t axis : {0u, 1u, 2u}) {
        std::vector<double> indices;
        for (const auto& node : study.sensors)
            indices.push_back(static_cast<double>(node[axis]));
        group.variables.push_back({.name = std::string(1, "ijk"[axis]),
                                   .dimensions = {"node"},
                                   .values = std::move(indices),
                                   .units = "1",
                                   .long_name = "index along an axis, from 0",
                                   .note = ""});
    }
    for (const engines::SensorSeries& series : sensors)
        group.variables.push_back({.name = series.field,
                                   .dimensions = {"node", "time"},
                                   .values = series.values,
                                   .units = series.velocity ? "m/s" : "Pa",
                                   .long_name = series.velocity ? "particle velocity" : "stress",
                                   .note = ""});
    return group;
}

std::vector<Attribute> case_attributes(const PlannedCase& planned, const RunFacts& facts) {
    const bool short_enough = facts.job_text.size() <= h5::largest_text;
    std::vector<Attribute> attributes = {
        {"title", facts.job_title},
        {"Conventions", std::string("CF-1.8")},
        {"case_id", planned.id},
        {"case", canonical_text(planned.physics)},
        {"settings", storage::settings_text(planned.settings)},
        {"is_reference", std::string(planned.is_reference ? "yes" : "no")},
        {"reference_id", planned.reference_id},
        {"job", short_enough ? facts.job_text
                             : fmt::format("{} bytes: see job.toml next to the folder of the cases",
                                           facts.job_text.size())}};
    if (!facts.overrides.empty()) attributes.push_back({"overrides", facts.overrides});
    for (Attribute& attribute : program_attributes())
        attributes.push_back(std::move(attribute));
    attributes.push_back({"ranks", static_cast<long>(facts.ranks)});
    attributes.push_back({"wall_s", facts.wall_s});
    attributes.push_back({"started", facts.started});
    attributes.push_back({"ended", facts.ended});
    const engines::SolverReport& solver = facts.solver;
    if (!solver.notes.empty())
        attributes.push_back({"solver_notes", fmt::format("{}", fmt::join(solver.notes, "\n"))});
    attributes.push_back({"columns_in_samples", facts.columns_in_samples});
    attributes.push_back({"warnings", storage::warnings_text(facts.warnings)});
    if (solver.steps > 0) {
        attributes.push_back({"solver_steps", static_cast<long>(solver.steps)});
        attributes.push_back({"solver_iterations", static_cast<long>(solver.iterations)});
        attributes.push_back({"solver_most_iterations", static_cast<long>(solver.most_iterations)});
        attributes.push_back({"solver_work_J", solver.work_J});
        attributes.push_back({"solver_energy_J", solver.energy_J});
    }
    if (solver.period_energy) {
        attributes.push_back({"period_work_J", solver.period_energy->work_J});
        attributes.push_back({"period_absorbed_J", solver.period_energy->absorbed_in_layers_J});
        attributes.push_back({"period_radiated_J", solver.period_energy->radiated_J});
        attributes.push_back({"period_imbalance", solver.period_energy->imbalance()});
    }
    attributes.push_back({"status", std::string("complete")});
    return attributes;
}

} // namespace shearwake::pipeline
