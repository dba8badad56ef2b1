// SPDX-License-Identifier: BSD-3-Clause
#include "base/json.hpp"
#include "studies/laboratory/laboratory.hpp"

#include "base/units.hpp"
#include "engines/engine.hpp"
#include "parallel/agree.hpp"
#include "pipeline/compute.hpp"
#include "pipeline/run_case.hpp"
#include "schedule/run/run.hpp"
#include "storage/checksum/checksum.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"
#include "studies/laboratory/observed_data.hpp"
#include "studies/tables.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace shearwake::laboratory {
namespace {

using Columns = std::map<std::string, std::vector<double>>; // one value per repetition

constexpr std::uintmax_t largest_fit_B = 4'000'000;

/// Passes measured frames of the surface to an observer as an engine passes computed ones, so that
/// measurements have the same measures and files as simulations.
class ReplayEngine : public engines::FrameSource {
public:
    /// `prefix`: of the converted surface (ConvertedData); `repetition`: 0 for the data themselves.
    ReplayEngine(std::filesystem::path prefix, std::size_t repetition,
                 std::vector<std::string> notes)
        : prefix_(std::move(prefix)), repetition_(repetition), notes_(std::move(notes)) {}

    engines::Resources resources(const Case& c, int) const override {
        return {.arrays = {{"frame", static_cast<double>(c.domain.nx) *
                                         static_cast<double>(c.domain.ny) * sizeof(double)}}};
    }
    /// Errors for what a measurement does not contain: depths, stress, volumes.
    static std::vector<Remark> limits(const Case& c) {
        std::vector<Remark> remarks;
        const auto refuse = [&](const char* key, const char* message) {
            remarks.push_back({Severity::error, key, message});
        };
        if (c.measure.depths_m != std::vector<double>{0.0})
            refuse("measure.depths_mm", "a scan contains the surface only: set it to [0]");
        if (!c.record.volumes_s.empty())
            refuse("record.volumes_ms", "a scan contains the surface only: remove this key");
        if (!stress_depths_m(c).empty())
            refuse("afferents.input", "a scan contains no stress: use \"displacement\"");
        return remarks;
    }
    void run(const Case& c, const Comm& team, engines::Observer& observer,
             engines::Checkpoints* checkpoints) override {
        const std::ptrdiff_t ranks = team.size(), rank = team.rank();
        const std::ptrdiff_t start = c.domain.nx * rank / ranks,
                             end = c.domain.nx * (rank + 1) / ranks;
        const auto plane_size = static_cast<std::size_t>(c.domain.nx * c.domain.ny);
        std::vector<double> plane(plane_size);
        observer.begin({start, end - start});
        for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
            if (checkpoints && checkpoints->stop_asked()) return;
            const std::size_t frame =
                repetition_ * static_cast<std::size_t>(c.time.frames) + static_cast<std::size_t>(n);
            on_root(team, [&] { read_numbers(prefix_, frame * plane_size, plane); });
            team.broadcast(plane);
            observer.frame({.number = n,
                            .depth = 0,
                            .u_z_m = View2<const double>(plane.data() + start * c.domain.ny,
                                                         end - start, c.domain.ny, c.domain.ny)});
        }
        engines::SolverReport report;
        report.notes = notes_;
        observer.solved(report);
    }

private:
    std::filesystem::path prefix_;
    std::size_t repetition_;
    std::vector<std::string> notes_;
};

/// The estimates of `shearwake fit` as overrides. Not collective.
std::vector<std::string> estimates_in(const std::filesystem::path& file) {
    std::vector<std::string> overrides;
    try {
        const Json root = Json::parse(storage::read_file(file, largest_fit_B));
        for (const auto& [key, estimate] : root.at("estimates").items())
            overrides.push_back(fmt::format("{}={:.17g}", key, estimate.at("value").get<double>()));
    } catch (const JsonError& error) {
        throw UsageError(
            fmt::format("{} is not a fit.json of shearwake fit: {}", file.string(), error.what()));
    }
    return overrides;
}

/// The job with its vibrometer, which describes the scan, and without it, for the measures.
struct MeasuredJob {
    config::Job with_scan, job;
    const PlannedCase& planned() const { return job.plan.cases.front(); }
};

MeasuredJob read_measured_job(const MeasureArguments& arguments, const Comm& world) {
    std::vector<std::string> overrides;
    together(world, [&] {
        if (!arguments.fit.empty()) overrides = estimates_in(arguments.fit);
    });
    overrides.insert(overrides.end(), arguments.overrides.begin(), arguments.overrides.end());
    overrides = studies::one_case_overrides(overrides);
    config::Job with_scan = schedule::load_job(arguments.job, overrides, world);
    std::erase_if(overrides, [](const auto& text) { return text.starts_with("vibrometer."); });
    overrides.emplace_back("vibrometer={}");
    return {std::move(with_scan), schedule::load_job(arguments.job, overrides, world)};
}

void require_measurable(const Case& c) {
    std::string errors;
    for (const Remark& remark : ReplayEngine::limits(c))
        errors += fmt::format("{}{}: {}", errors.empty() ? "" : "\n", remark.key, remark.message);
    if (!errors.empty()) throw UsageError(errors, ExitCode::bad_job);
}

Json request_of(const MeasureArguments& arguments, const MeasuredJob& measured) {
    const Case& c = measured.planned().physics;
    Json request = scan_request(arguments, measured.with_scan.plan.cases.front().physics);
    request["grid"] = {{"nx", c.domain.nx}, {"ny", c.domain.ny}, {"spacing_m", c.domain.spacing_m}};
    Json frames = Json::array();
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
        frames.push_back(c.time.frame_s(n));
    request["frames_s"] = frames;
    request["high_pass_Hz"] = arguments.high_pass_Hz;
    request["gaps"] = arguments.gaps;
    request["repetitions"] = arguments.repetitions;
    request["seed"] = 1;
    return request;
}

/// The scalars of the root group of a case file are the columns of tables.
void add_columns_of(const std::vector<VariableGroup>& groups, Columns& columns) {
    for (const Variable& variable : groups.front().variables)
        if (variable.dimensions.empty()) columns[variable.name].push_back(variable.values.front());
}

/// The columns of the repetitions, on the root. Collective.
Columns repeated_columns(const PlannedCase& planned, const std::filesystem::path& prefix,
                         std::size_t repetitions, const Comm& world) {
    Columns columns;
    for (std::size_t n = 1; n < repetitions; ++n) {
        ReplayEngine engine(prefix, n, {});
        const auto plan = pipeline::plan_case(planned.physics, world.size(), engine);
        const auto results = pipeline::compute(planned, plan, engine, world, {});
        if (world.is_root()) add_columns_of(results->groups, columns);
    }
    return columns;
}

/// NaN for fewer than two finite values.
double standard_deviation(const std::vector<double>& values) {
    double sum = 0.0, squares = 0.0, count = 0.0;
    for (const double value : values)
        if (std::isfinite(value)) {
            sum += value;
            count += 1.0;
        }
    for (const double value : values)
        if (std::isfinite(value)) squares += (value - sum / count) * (value - sum / count);
    return count < 2.0 ? not_a_number : std::sqrt(squares / (count - 1.0));
}

std::map<std::string, double> errors_of(const Columns& repeated) {
    std::map<std::string, double> errors;
    for (const auto& [name, values] : repeated)
        errors[name] = standard_deviation(values);
    return errors;
}

void write_uncertainty(const Measurement& measured, const ConvertedData& data) {
    Json entries = Json::object();
    for (const auto& [name, error] : measured.errors)
        entries[name] = {{"error", std::isfinite(error) ? Json(error) : Json(nullptr)}};
    const Json root = {{"schema", 1},
                       {"data", data.data},
                       {"sha256", data.sha256},
                       {"repetitions", data.repetitions - 1},
                       {"notes", data.notes},
                       {"cases", Json::array({{{"id", measured.id}, {"columns", entries}}})}};
    storage::write_file(measured.folder.uncertainty(), storage::seal(root.dump(2) + "\n"));
}

/// A warning if the measures refer to an area that the scan does not cover; empty if it does.
std::string uncovered_text(const Case& c, const ConvertedData& data) {
    const double step = 1.01 * c.domain.spacing_m;
    Vec2 from = {c.domain.x_m(0) + c.domain.sponge_m, c.domain.y_m(0) + c.domain.sponge_m},
         to = {c.domain.x_m(c.domain.nx - 1) - c.domain.sponge_m,
               c.domain.y_m(c.domain.ny - 1) - c.domain.sponge_m};
    if (!c.measure.region_m.empty()) {
        from = to = c.measure.region_m.front();
        for (const Vec2 corner : c.measure.region_m) {
            from = {std::min(from.x, corner.x), std::min(from.y, corner.y)};
            to = {std::max(to.x, corner.x), std::max(to.y, corner.y)};
        }
    }
    if (data.covered_from_m.x <= from.x + step && data.covered_from_m.y <= from.y + step &&
        data.covered_to_m.x >= to.x - step && data.covered_to_m.y >= to.y - step)
        return "";
    const Vec2 size = data.covered_to_m - data.covered_from_m,
               centre = 0.5 * (data.covered_to_m + data.covered_from_m);
    return fmt::format(
        "warning: the scan does not cover the measured area, whose remainder counts as at rest; "
        "set measure.region_mm = [{:.6g}, {:.6g}] and measure.region_center_mm = [{:.6g}, {:.6g}], "
        "also for a simulation that is compared with it",
        1e3 * size.x, 1e3 * size.y, 1e3 * centre.x, 1e3 * centre.y);
}

/// Writes the case file of the data. Collective.
void write_case(const PlannedCase& planned, const config::Job& job,
                const schedule::OutputFolder& folder, const std::filesystem::path& prefix,
                const std::vector<std::string>& notes, const Comm& world) {
    const storage::Journal journal(folder.journal(storage::process_name()));
    pipeline::CaseCheckpoints checkpoints(folder.checkpoints(planned.id), {planned.id, ""}, {},
                                          world, journal,
                                          {[] { return false; }, [](const std::string&) {}});
    ReplayEngine engine(prefix, 0, notes);
    const auto outcome =
        pipeline::run_case(planned,
                           {.title = job.plan.title + " (measurement)",
                            .text = job.text,
                            .overrides = "",
                            .memory_per_rank_B = std::numeric_limits<double>::infinity()},
                           engine, world, folder.case_file(planned.id), checkpoints, [] {});
    on_root(world, [&] {
        journal.started(planned.id, world.size());
        journal.finished(planned.id, outcome ? outcome->seconds : 0.0, "measurement",
                         outcome ? outcome->checksum : "");
    });
}

} // namespace

Measurement measure(const MeasureArguments& arguments, const Comm& world) {
    const MeasuredJob measured = read_measured_job(arguments, world);
    const PlannedCase& planned = measured.planned();
    require_measurable(planned.physics);
    Measurement result{
        .folder = schedule::output_folder(arguments.out, measured.job.plan.name + ".measure"),
        .id = planned.id};
    const std::filesystem::path prefix = result.folder.root / "scan";
    ConvertedData data;
    on_root(world, [&] {
        schedule::prepare_output(result.folder, measured.job);
        warn_of_overrides(arguments);
        convert_scan(arguments.data, request_of(arguments, measured), prefix);
    });
    together(world, [&] { data = read_surface(prefix); });
    result.notes = {fmt::format("measured: {}, SHA-256 {}", data.data, data.sha256)};
    result.notes.insert(result.notes.end(), data.notes.begin(), data.notes.end());
    result.warning = uncovered_text(planned.physics, data);
    write_case(planned, measured.job, result.folder, prefix, result.notes, world);
    result.errors = errors_of(repeated_columns(planned, prefix, data.repetitions, world));
    on_root(world, [&] {
        remove_converted(prefix);
        write_uncertainty(result, data);
    });
    return result;
}

} // namespace shearwake::laboratory
