// SPDX-License-Identifier: BSD-3-Clause
#include "serve/solver.hpp"

#include "base/error.hpp"
#include "base/units.hpp"
#include "config/job.hpp"
#include "engines/registry/check.hpp"
#include "engines/registry/make_engine.hpp"
#include "parallel/agree.hpp"
#include "pipeline/afferent_result.hpp"
#include "pipeline/compute.hpp"
#include "pipeline/memory.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::serve {

namespace {

/// Throws UsageError with the errors about the afferents.
void check_receptors(const Case& c) {
    if (!c.afferents) return;
    std::string errors;
    for (const Remark& remark : pipeline::check_afferents(c))
        if (remark.severity == Severity::error)
            errors += fmt::format("{}afferents.{}: {}", errors.empty() ? "" : "\n", remark.key,
                                  remark.message);
    if (!errors.empty()) throw UsageError(errors, ExitCode::bad_job);
}

Json points(const std::vector<Vec2>& all) {
    Json list = Json::array();
    for (const Vec2 point : all)
        list.push_back({point.x, point.y});
    return list;
}

/// What a display needs in addition to the results.
Json description(const PlannedCase& planned) {
    const Case& c = planned.physics;
    const double width_m = fwhm_m(c.scene.load.footprint);
    return {{"case", planned.id},
            {"spacing_m", c.domain.spacing_m},
            {"fwhm_m", width_m},
            {"foci_m", points(c.scene.load.modulation.foci_m)},
            {"surface_wave_m_s", rayleigh_speed_m_s(surface_wave_layer(c.scene.medium, width_m))}};
}

Json warnings_of(const Case& c, const pipeline::CaseResults& results) {
    Json list = Json::array();
    for (const Remark& remark : pipeline::case_warnings(c, results, check(c)))
        list.push_back({{"severity", remark.severity == Severity::error ? "error" : "warning"},
                        {"key", remark.key},
                        {"message", remark.message}});
    return list;
}

} // namespace

config::TextLoader texts_in(const std::filesystem::path& files) {
    if (files.empty()) return nullptr;
    return [files](const std::string& file) { return storage::read_user_text(files, file); };
}

config::Job read_request(const Request& request, const std::filesystem::path& files) {
    std::vector<config::Override> overrides = request.overrides;
    for (const char* axes : {"sweep", "uncertain", "table"})
        overrides.push_back({axes, "{}"});
    return config::read_job(request.job, "job", overrides, nullptr, texts_in(files));
}

Solver::Solver(const Limits& limits, std::filesystem::path files, const Comm& world)
    : limits_(limits), files_(std::move(files)), world_(world) {}

pipeline::CasePlan Solver::suitable_plan(const Case& c, const Request& request) const {
    const bool with_frames = request.wants("u_z");
    if (engines::capabilities_of(c).steps_in_time)
        throw UsageError(fmt::format("solver.engine: serve computes with engine \"layered\" only, "
                                     "not with \"{}\"; use run",
                                     engine_name(c.solver)));
    const double values = static_cast<double>(c.domain.nx) * static_cast<double>(c.domain.ny) *
                          static_cast<double>(c.time.frames);
    if (with_frames && !(values <= limits_.values))
        throw UsageError(fmt::format("the case has {} x {} points and {} frames, {:.3g} values; "
                                     "serve computes at most {:.3g}",
                                     c.domain.nx, c.domain.ny, c.time.frames, values,
                                     limits_.values));
    pipeline::CasePlan plan = pipeline::plan_case(c, world_.size(), *engine_);
    const double receptors = plan.receptors ? pipeline::receptors_work(c, *plan.receptors) : 0.0;
    if (!(receptors <= limits_.receptor_operations))
        throw UsageError(
            fmt::format("the receptors need {:.3g} operations; serve computes at most {:.3g}",
                        receptors, limits_.receptor_operations));
    const double frames_B = with_frames ? 2.0 * values * sizeof(float) : 0.0;
    const double needed_B = plan.needs.memory_per_rank_B() + frames_B;
    if (!(needed_B <= limits_.memory_per_rank_B))
        throw UsageError(fmt::format("the case needs {:.2f} GB per rank; serve uses at most {:.2f} "
                                     "GB",
                                     needed_B / 1e9, limits_.memory_per_rank_B / 1e9));
    return plan;
}

bool Solver::compute(const Request& request, Interrupt& interrupt, Answer& answer) {
    const auto began = Clock::now();
    const bool with_frames = request.wants("u_z");
    const config::Job job = read_request(request, files_);
    if (interrupt.stop_asked()) return false;
    PlannedCase planned = job.plan.cases.front();
    if (!request.wants_receptors()) planned.physics.afferents.reset();
    const Case& c = planned.physics;
    if (const std::string error = pipeline::size_error(job.text, c); !error.empty())
        throw UsageError(error, ExitCode::bad_job);
    if (!engine_) engine_ = engines::make_engine(SolverOptions{});
    const pipeline::CasePlan plan = suitable_plan(c, request);
    check_receptors(c);
    if (interrupt.stop_asked()) return false;
    auto results =
        pipeline::compute(planned, plan, *engine_, world_,
                          {.checkpoints = &interrupt, .frames = with_frames ? &frames_ : nullptr});
    if (!results) return false;
    on_root(world_, [&] {
        answer.members = description(planned);
        answer.members["warnings"] = warnings_of(c, *results);
        answer.members["seconds"] = seconds_since(began);
        answer.groups = std::move(results->groups);
        if (with_frames) answer.frames = {frames_, c.time.frames, c.domain.nx, c.domain.ny};
    });
    return true;
}

} // namespace shearwake::serve
