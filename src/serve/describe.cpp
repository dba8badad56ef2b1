// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "config/sweep/override.hpp"
#include "config/sweep/sweep.hpp"
#include "sampling/distribution.hpp"
#include "serve/solver.hpp"

#include <cmath>
#include <variant>

namespace shearwake::serve {
namespace {

/// Studies try no value beyond these quantiles of a distribution.
constexpr double tail = 1e-9;

/// The normal prior of a number, or of its logarithm. Null for a uniform or triangular
/// distribution, which gives bounds alone.
Json prior_of(const sampling::Distribution& distribution) {
    if (std::holds_alternative<sampling::Uniform>(distribution.shape) ||
        std::holds_alternative<sampling::Triangular>(distribution.shape))
        return nullptr;
    const auto* shape = std::get_if<sampling::LogNormal>(&distribution.shape);
    if (shape && distribution.root_of == 0.0)
        return {{"mean", std::log(shape->median)},
                {"sd", std::log(shape->geometric_sd)},
                {"logarithmic", true}};
    const double low = sampling::quantile(distribution, 0.158655),
                 high = sampling::quantile(distribution, 0.841345);
    return {{"mean", 0.5 * (low + high)}, {"sd", 0.5 * (high - low)}, {"logarithmic", false}};
}

Json uncertain_of(const Request& request, const std::filesystem::path& files,
                  config::DiagnosticList& diagnostics) {
    Json keys = Json::array();
    const config::NodePtr tree =
        config::job_tree(request.job, "job", request.overrides, diagnostics);
    std::vector<std::string> names;
    if (tree)
        for (const config::UncertainKey& key :
             config::uncertain_keys(tree, {nullptr, texts_in(files)}, diagnostics)) {
            names.push_back(key.key);
            keys.push_back({{"key", key.key},
                            {"median", sampling::quantile(key.distribution, 0.5)},
                            {"low", sampling::quantile(key.distribution, tail)},
                            {"high", sampling::quantile(key.distribution, 1.0 - tail)},
                            {"prior", prior_of(key.distribution)}});
        }
    if (diagnostics.errors() > 0) throw config::BadJob(diagnostics.sorted());
    config::check_overrides(tree, request.overrides, names, diagnostics);
    return keys;
}

Json vibrometer_of(const Case& c) {
    if (!c.vibrometer) return nullptr;
    const VibrometerOptions& o = *c.vibrometer;
    const Vec3 along = o.line_of_sight();
    return {{"trigger_delay_s", o.trigger_delay_s},
            {"offset_m", {o.offset_x_m, o.offset_y_m}},
            {"direction", {along.x, along.y, along.z}},
            {"tilt_rad", o.tilt_rad},
            {"azimuth_rad", o.azimuth_rad},
            {"spot_m", o.spot_m},
            {"high_pass_Hz", o.high_pass_Hz},
            {"low_pass_Hz", o.low_pass_Hz}};
}

} // namespace

Json describe(const Request& request, const std::filesystem::path& files) {
    const config::Job job = read_request(request, files);
    const PlannedCase& planned = job.plan.cases.front();
    const Case& c = planned.physics;
    config::DiagnosticList diagnostics;
    Json uncertain = uncertain_of(request, files, diagnostics);
    return {{"case", planned.id},
            {"name", job.plan.name},
            {"engine", engine_name(c.solver)},
            {"periodic", c.time.regime == Regime::periodic},
            {"duration_s", c.time.duration_s()},
            {"interval_s", c.time.interval_s},
            {"extent_m", {c.domain.extent_x_m(), c.domain.extent_y_m()}},
            {"vibrometer", vibrometer_of(c)},
            {"uncertain", std::move(uncertain)},
            {"diagnostics", config::json_of(diagnostics.sorted())}};
}

} // namespace shearwake::serve
