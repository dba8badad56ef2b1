// SPDX-License-Identifier: BSD-3-Clause
#include "engines/engine.hpp"
#include "engines/spectral/bodies/rigid_choice.hpp"
#include "engines/spectral/spectral_engine.hpp"
#include "engines/spectral/spectral_plan.hpp"
#include "engines/spectral/stepping/time_step.hpp"
#include "problem/medium/body.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <limits>
#include <span>

namespace shearwake::spectral {

namespace {

/// Error in % of the waves that a body scatters, by its stiffness and the spacings per radius:
/// docs/explanation/engine-spectral.md, "Errors at bodies" and "Rigid bodies".
struct ErrorTable {
    std::span<const double> per_radius, percent;
};
constexpr std::array elastic_radii = {1.0, 2.0, 4.0, 5.0, 7.5, 10.0};
struct MeasuredErrors {
    double up_to; // stiffness relative to the layer
    std::array<double, elastic_radii.size()> percent;
};
constexpr std::array measured = {
    MeasuredErrors{0.2, {21, 8.1, 2.9, 1.9, 0.9, 0.6}},
    MeasuredErrors{20.0, {7.2, 2.7, 2.0, 1.3, 0.9, 0.7}},
    MeasuredErrors{100.0, {8.5, 4.8, 1.8, 1.4, 0.8, 0.7}},
    MeasuredErrors{std::numeric_limits<double>::infinity(), {17, 12, 6.2, 5.2, 3.0, 2.3}}};
constexpr std::array rigid_radii = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.5, 10.0},
                     rigid_sphere = {156.0, 56.0, 16.0, 8.2, 5.3, 2.3, 2.2, 1.1},
                     rigid_endless = {43.0, 5.1, 3.3, 2.9, 2.4, 2.1, 2.0, 1.3};
constexpr double good_percent = 5.0;

ErrorTable measured_errors(const Body& body, double contrast, const Domain& domain) {
    if (body.rigid)
        return {rigid_radii,
                endless_along(body, domain) == Endless::no ? rigid_sphere : rigid_endless};
    return {elastic_radii, std::ranges::find_if(measured, [=](const MeasuredErrors& m) {
                               return contrast <= m.up_to;
                           })->percent};
}

/// `c` contains the bodies that are treated as rigid.
std::vector<Remark> resolution_remarks(const Case& c) {
    std::vector<Remark> remarks;
    for (std::size_t i = 0; i < c.scene.medium.bodies.size(); ++i) {
        const Body& body = c.scene.medium.bodies[i];
        const double contrast = stiffness_contrast(body, c.scene.medium);
        const double width_m = lateral_thickness_m(body),
                     radius = 0.5 * width_m / c.domain.spacing_m;
        if (radius < 1.0) continue; // check_variation
        if (body.rigid ? !has_markers(body, c.scene.medium, c.domain)
                       : contrast == 0.0 || contrast == 1.0)
            continue;
        const auto [per_radius, percent] = measured_errors(body, contrast, c.domain);
        std::size_t own = 0, good = 0;
        while (own + 1 < per_radius.size() && per_radius[own + 1] <= radius)
            ++own;
        while (percent[good] > good_percent)
            ++good;
        if (own >= good) continue;
        remarks.push_back(
            {Severity::warning, fmt::format("medium.body[{}].shape", i + 1),
             fmt::format("it is {:.2g} grid spacings wide along the surface and {}: the waves that "
                         "a body scatters are then in error by about {:.2g} % at a width of {:.2g} "
                         "spacings and {:.2g} % at {:.2g}; use domain.spacing_mm = {:.3g}",
                         2.0 * radius,
                         body.rigid ? "rigid"
                                    : fmt::format("{:.2g} times as stiff as its layer", contrast),
                         percent[own], 2.0 * per_radius[own], percent[good], 2.0 * per_radius[good],
                         0.5e3 * width_m / per_radius[good])});
    }
    return remarks;
}

} // namespace

std::vector<Remark> SpectralEngine::limits(const Case& c) const {
    std::vector<Remark> refused = engines::refused_losses(c);
    for (std::size_t i = 0; i < c.scene.medium.bodies.size(); ++i)
        if (is_fluid(c.scene.medium.bodies[i]) && !c.scene.medium.bodies[i].rigid)
            refused.push_back({Severity::error, fmt::format("medium.body[{}].c_s_m_s", i + 1),
                               "is 0, a fluid, which only the engine \"pstd\" supports"});
    for (Remark& remark : engines::refused_edges(c))
        refused.push_back(std::move(remark));
    for (Remark& remark : rigid_limits(c))
        refused.push_back(std::move(remark));
    const Case chosen = rigid_plan(c).marked;
    for (Remark& warning : receptors_near_bodies(chosen))
        refused.push_back(std::move(warning));
    for (Remark& warning : resolution_remarks(chosen))
        refused.push_back(std::move(warning));
    for (Remark& warning : engines::warnings_of(cap_choices(chosen)))
        refused.push_back(std::move(warning));
    return refused;
}

engines::Capabilities SpectralEngine::capabilities(const Case& c) const {
    return {.edges = c.domain.sponge_m > 0.0 ? engines::Edges::sponge : engines::Edges::periodic};
}

engines::StepChooser SpectralEngine::step_chooser(const Case& c) const {
    if (std::get<SpectralOptions>(c.solver).time_step_s) return {};
    return [&](engines::ChoiceLimit limit) { return plan_of(c, limit).time.step_s; };
}

} // namespace shearwake::spectral
