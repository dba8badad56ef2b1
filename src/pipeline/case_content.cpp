// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/case_content.hpp"

#include "engines/registry/check.hpp"
#include "engines/registry/make_engine.hpp"
#include "measures/measure_table.hpp"
#include "measures/spectrum.hpp"
#include "measures/window.hpp"
#include "parallel/agree.hpp"
#include "pipeline/afferent_result.hpp"
#include "pipeline/provenance.hpp"
#include "pipeline/vibrometer.hpp"
#include "problem/case/edges.hpp"
#include "problem/load/footprint.hpp"
#include "storage/case_file/groups.hpp"
#include "storage/hdf5/h5.hpp"
#include "storage/journal/plan_file.hpp"

#include <algorithm>
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

VariableGroup root_series(const Case& c, const std::vector<measures::DepthSeries>& depths) {
    const Trajectory& trajectory = c.scene.load.modulation.trajectory;
    Load averaged = c.scene.load; // frames do not resolve the carrier
    averaged.carrier = AveragedCarrier{};
    const auto time = over_time(c, [](double t) { return t; });
    VariableGroup root;
    root.add("time", {"time"}, time, "s", "time since the load began");
    root.add("depth", {"depth"}, c.measure.depths_m, "m", "depth below the skin surface");
    root.add("focus_x", {"time"}, over_time(c, [&](double t) { return position(trajectory, t).x; }),
             "m", "position of the focus along x");
    root.add("focus_y", {"time"}, over_time(c, [&](double t) { return position(trajectory, t).y; }),
             "m", "position of the focus along y");
    root.add("force", {"time"}, forces_N(averaged, time), "N",
             "force of the whole footprint, averaged over the carrier's cycle");
    for (const measures::FrameMeasure& measure : measures::frame_measures())
        root.variables.push_back(series(depths, measure));
    return root;
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
    VariableGroup group{"traces", {}};
    group.add("trace", {"trace"}, number, "1", "number of the trace point");
    group.add("time", {"time"}, over_time(c, [](double t) { return t; }), "s",
              "time since the load began");
    group.add("frequency", {"frequency"}, frequencies, "Hz", "frequency");
    group.add("x", {"trace"}, x, "m", "position of the trace point along x");
    group.add("y", {"trace"}, y, "m", "position of the trace point along y");
    group.add("u_z", {"trace", "time"}, u, "m", "normal displacement, positive into the tissue");
    group.add("amplitude", {"trace", "frequency"}, amplitude, "m",
              "one-sided amplitude spectrum of u_z over the run (its mean at 0 Hz)");
    return group;
}

VariableGroup mean_group(const Case& c, const std::vector<double>& mean_u2) {
    const Domain& d = c.domain;
    std::vector<double> number, line, x, y;
    const auto lines = drawn_shape(c.scene.load.modulation, d.spacing_m);
    for (std::size_t l = 0; l < lines.size(); ++l)
        for (const Vec2 point : lines[l]) {
            number.push_back(static_cast<double>(number.size()));
            line.push_back(static_cast<double>(l));
            x.push_back(point.x);
            y.push_back(point.y);
        }
    VariableGroup group{"mean", {}};
    group.add("x", {"x"}, storage::coordinate(d.nx, [&](auto i) { return d.x_m(i); }), "m", "x");
    group.add("y", {"y"}, storage::coordinate(d.ny, [&](auto j) { return d.y_m(j); }), "m", "y");
    group.add("u_z_squared", {"x", "y"}, mean_u2, "m2",
              "time mean of u_z^2 over whole modulation periods");
    group.add("point", {"point"}, number, "1", "number of the point of the drawn shape");
    group.add("drawn_line", {"point"}, line, "1",
              "number of the line of the drawn shape, one per focus");
    group.add("drawn_x", {"point"}, x, "m", "x of the drawn shape");
    group.add("drawn_y", {"point"}, y, "m", "y of the drawn shape");
    return group;
}

VariableGroup sensation_group(const Case& c, const measures::SensationMap& map) {
    const Domain& d = c.domain;
    VariableGroup group{"sensation", {}};
    group.add("x", {"x"}, storage::coordinate(map.rows, [&](auto i) { return d.x_m(map.x0 + i); }),
              "m", "x");
    group.add("y", {"y"},
              storage::coordinate(map.columns, [&](auto j) { return d.y_m(map.y0 + j); }), "m",
              "y");
    group.add("level", {"x", "y"}, map.level_dB, "dB",
              "level of the acceleration above the threshold of perception");
    group.add("band", {"x", "y"}, map.band_Hz, "Hz", "third octave that decides the level");
    return group;
}

/// The energies of a period as columns; none without them.
std::vector<measures::Column> energy_columns(const engines::SolverReport& solver) {
    if (!solver.period_energy) return {};
    const engines::PeriodEnergy& energy = *solver.period_energy;
    return {measures::column_of("period_work_uJ", 1e6 * energy.work_J, {}),
            measures::column_of("period_absorbed_uJ", 1e6 * energy.absorbed_in_layers_J, {}),
            measures::column_of("period_radiated_uJ", 1e6 * energy.radiated_J, {})};
}

} // namespace

std::vector<VariableGroup> field_content(const Case& c,
                                         const std::vector<measures::DepthSeries>& depths,
                                         const std::vector<measures::TraceSeries>& traces,
                                         const std::optional<measures::MachFit>& mach,
                                         const std::vector<double>& mean_u2) {
    std::vector<VariableGroup> groups = {root_series(c, depths)};
    add_columns(measures::summarise(c, depths, traces, mach, mean_u2), groups.front());
    if (!traces.empty()) groups.push_back(trace_group(c, traces));
    if (!mean_u2.empty()) groups.push_back(mean_group(c, mean_u2));
    return groups;
}

void add_columns(const std::vector<measures::Column>& columns, VariableGroup& group) {
    for (const measures::Column& column : columns)
        group.add(column.name, {}, {column.value}, column.unit, column.long_name, column.note);
}

std::vector<VariableGroup> case_content(const Case& c, const SurfaceRecorder& recorder,
                                        AfferentResult afferents) {
    std::vector<VariableGroup> groups =
        field_content(c, recorder.depths(), recorder.traces(), recorder.mach(), recorder.mean_u2());
    add_columns(measures::sensation_columns(c, recorder.sensation()), groups.front());
    if (!recorder.sensation().level_dB.empty())
        groups.push_back(sensation_group(c, recorder.sensation()));
    add_columns(energy_columns(recorder.solver()), groups.front());
    add_columns(afferents.columns, groups.front());
    for (VariableGroup& group : afferents.groups)
        groups.push_back(std::move(group));
    if (c.vibrometer) groups.push_back(vibrometer_group(c, recorder.scan_m()));
    return groups;
}

std::string columns_in_samples(const VariableGroup& root) {
    std::vector<std::string> names;
    for (const Variable& variable : root.variables)
        if (measures::counts_samples(variable.name)) names.push_back(variable.name);
    return fmt::format("{}", fmt::join(names, " "));
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

namespace {

constexpr const char* extent_key = "domain.extent_mm";
/// Energy on the edges, relative to the mean, above which the readings are not valid: it returns
/// through the opposite edge, so that it is also the order of the relative error of eta.
constexpr double invalid_share = 0.05;
/// Below this share, returning waves change no digit that a report prints.
constexpr double negligible_share = 1e-3;

/// Replaces the expectation of `check` by what was computed.
void check_returning_waves(double share, std::vector<Remark>& warnings) {
    std::erase_if(warnings, [&](const Remark& remark) {
        return remark.key == extent_key && share < negligible_share;
    });
    for (Remark& remark : warnings) {
        if (remark.key != extent_key) continue;
        const bool invalid = share > invalid_share;
        remark.message += fmt::format(
            ". On the edges of the domain, u_z^2 is {:.2g} % of its mean: {}", 100.0 * share,
            invalid ? "the readings of this case are not valid"
                    : "errors of eta are at most of this order, those of ipr_abs several times "
                      "larger");
        if (invalid) remark.severity = Severity::error;
    }
}

/// The changes of the field (relative L2) and of eta above which the uplift by images is reported.
constexpr double tolerated_change = 0.1, tolerated_eta_change = 0.02;

/// Over the frames that are measured. The images lower u_z by the uplift at all points, in the
/// focal disc as well, where u_z is taken to have its rms value and to press.
void check_image_uplift(const Case& c, std::span<const measures::SurfaceSums> surface,
                        std::vector<Remark>& warnings) {
    const bool invalid = std::ranges::any_of(warnings, [](const Remark& remark) {
        return remark.key == extent_key && remark.severity == Severity::error;
    });
    if (invalid || surface.empty() || !has_image_uplift(c)) return;
    const double cells = measures::measured_region(c.domain, c.measure).cells();
    const std::vector<double> uplift_m = image_uplift_m(c);
    const auto weights =
        measures::window_weights(c.time, c.measure.settled_after_s, c.measure.at_s);
    double square = 0.0, energy = 0.0, focal = 0.0, open_energy = 0.0, open_focal = 0.0;
    for (std::size_t n = 0; n < surface.size(); ++n) {
        const measures::SurfaceSums& sums = surface[n];
        const double w = weights[n], lift_m = uplift_m[n];
        const double focal_u = std::sqrt(sums.focal_u2 * sums.focal_weight);
        square += w * cells * lift_m * lift_m;
        energy += w * sums.u2;
        focal += w * sums.focal_u2;
        open_energy += w * (sums.u2 + lift_m * (2.0 * sums.u + cells * lift_m));
        open_focal += w * (sums.focal_u2 + lift_m * (2.0 * focal_u + sums.focal_weight * lift_m));
    }
    const double change = std::sqrt(square / open_energy);
    const double eta = focal > 0.0 ? focal / open_focal * open_energy / energy - 1.0 : 0.0;
    if (!(change > tolerated_change || std::abs(eta) > tolerated_eta_change)) return;
    warnings.push_back(
        {Severity::warning, extent_key,
         fmt::format("the skin rises around a load at once and at all distances; the images of the "
                     "load beyond the periodic edges lift the whole domain by about {:.2g} um at "
                     "the end of the run, which changes the field by an estimated {:.2g} % "
                     "(relative L2){}, and ipr_abs, the sum of all motion, by more; {}",
                     1e6 * uplift_m.back(), 100.0 * change,
                     focal > 0.0 ? fmt::format(", eta by {:.2g} %", 100.0 * std::abs(eta)) : "",
                     engines::capabilities_of(c).has_open_edges
                         ? "domain.edges = \"open\" avoids and measures it"
                         : "a domain of twice the size measures it")});
}

} // namespace

double edge_share(const Domain& domain, const std::vector<double>& mean_u2) {
    const auto at = [&](std::ptrdiff_t i, std::ptrdiff_t j) {
        return mean_u2[static_cast<std::size_t>(i * domain.ny + j)];
    };
    const double mean = std::accumulate(mean_u2.begin(), mean_u2.end(), 0.0) /
                        static_cast<double>(domain.nx * domain.ny);
    if (!(mean > 0.0)) return 0.0;
    // The rows i = 0 and i = nx - 1 are neighbours across the periodic edge.
    double edge = 0.0;
    for (std::ptrdiff_t i = 0; i < domain.nx; ++i)
        edge += at(i, 0);
    for (std::ptrdiff_t j = 1; j < domain.ny; ++j)
        edge += at(0, j);
    return edge / static_cast<double>(domain.nx + domain.ny - 1) / mean;
}

std::vector<Remark> case_warnings(const Case& c, const CaseResults& results,
                                  const std::vector<Remark>& expected) {
    std::vector<Remark> warnings = expected;
    if (engines::capabilities_of(c).edges == engines::Edges::periodic && !results.mean_u2.empty())
        check_returning_waves(edge_share(c.domain, results.mean_u2), warnings);
    check_image_uplift(c, results.surface, warnings);
    for (const Remark& warning : results.solver.warnings) // some follow from the case alone
        if (std::ranges::find(warnings, warning) == warnings.end()) warnings.push_back(warning);
    for (const std::string& line : results.afferents) {
        const std::size_t colon = line.find(": ");
        if (colon == std::string::npos) continue;
        warnings.push_back({Severity::warning, line.substr(0, colon), line.substr(colon + 2)});
    }
    return warnings;
}

} // namespace shearwake::pipeline
