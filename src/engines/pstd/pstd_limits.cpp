// SPDX-License-Identifier: BSD-3-Clause
#include "engines/engine.hpp"
#include "engines/pstd/pstd_engine.hpp"
#include "engines/pstd/scene/case_step.hpp"

#include <fmt/format.h>

namespace shearwake::pstd {
namespace {

/// Remarks about a specified time step. With bodies, the limits of the step require the materials
/// of all nodes, which only `plan` and `run` compute.
std::vector<Remark> step_remarks(const Case& c) {
    const auto& options = std::get<PstdOptions>(c.solver);
    if (!options.time_step_s || varies_laterally(c.scene.medium)) return {};
    const StepChoice step =
        choose_step(c, options, extremes_of_grid(c, options, case_grid(c, options)));
    auto remarks = engines::warnings_of(step_choices(options, step));
    for (Remark& remark : remarks)
        if (step.refused) remark.severity = Severity::error;
    return remarks;
}

/// Bodies of fewer points across need a remark.
constexpr double good_points_across = 5.0;

std::vector<Remark> resolution_remarks(const Case& c) {
    std::vector<Remark> remarks;
    const std::vector<Body>& bodies = c.scene.medium.bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const double width_m = lateral_thickness_m(bodies[i]);
        const double points = width_m / c.domain.spacing_m;
        if (points >= good_points_across || points < 2.0) continue; // check_variation
        remarks.push_back(
            {Severity::warning, fmt::format("medium.body[{}].shape", i + 1),
             fmt::format("it is {:.2g} grid spacings wide along the surface: the effect of a body "
                         "on the surface is in error by 4 to 10 % at 4 spacings and 3 to 8 % at 8; "
                         "use domain.spacing_mm = {:.3g}, or the engine \"spectral\"",
                         points, 1e3 * width_m / 8.0)});
    }
    return remarks;
}

} // namespace

std::vector<Remark> PstdEngine::limits(const Case& c) const {
    if (auto refused = engines::refused_edges(c); !refused.empty()) return refused;
    const auto& options = std::get<PstdOptions>(c.solver);
    std::vector<Remark> refused;
    if (const std::string error = device_error(options.device); !error.empty())
        refused.push_back({Severity::error, "solver.pstd.device", error});
    if (records_tensors(c.record))
        refused.push_back(
            {Severity::error, "record.volume_fields",
             "requests more than the displacement \"u\", which is all that the engine \"pstd\" "
             "stores; solver.engine = \"spectral\" also stores strain and stress"});
    if (!std::holds_alternative<GaussianFootprint>(c.scene.load.footprint))
        refused.push_back(
            {Severity::error, "load.footprint",
             "the engine \"pstd\" supports only Gaussian foci, not arrays and lenses; "
             "\"layered\" and \"spectral\" support all footprints"});
    for (std::size_t i = 0; i < c.scene.medium.bodies.size(); ++i)
        if (c.scene.medium.bodies[i].rigid)
            refused.push_back({Severity::error, fmt::format("medium.body[{}].rigid", i + 1),
                               "only the engine \"spectral\" supports rigid bodies; the engine "
                               "\"pstd\" needs the "
                               "material of the body"});
    const std::vector<Remark> losses = engines::refused_losses(c);
    refused.insert(refused.end(), losses.begin(), losses.end());
    for (const auto& more :
         {engines::warnings_of(case_choices(c, options)), step_remarks(c), resolution_remarks(c)})
        refused.insert(refused.end(), more.begin(), more.end());
    return refused;
}

engines::Capabilities PstdEngine::capabilities(const Case& c) const {
    const auto& options = std::get<PstdOptions>(c.solver);
    const bool absorb = options.edges == PstdEdges::absorbing || c.domain.sponge_m > 0.0;
    return {.edges = absorb ? engines::Edges::layer : engines::Edges::periodic,
            .is_driven_by_force = options.load == PstdLoad::traction};
}

} // namespace shearwake::pstd
