// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/spectral_plan.hpp"

#include "engines/spectral/bodies/rigid_choice.hpp"
#include "engines/spectral/lateral/cell_materials.hpp"
#include "problem/case/edges.hpp"
#include "problem/medium/material_field.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::spectral {
namespace {

/// Largest ratio of the shear stiffnesses of an inclusion and the layers around it, and the ratio
/// of densities there.
struct Contrast {
    double stiffness = 1.0, density = 1.0;
};

/// Widens the contrast by one material of an inclusion.
void add(const Layer& layer, std::optional<double> c_s_m_s, std::optional<double> density_kg_m3,
         Contrast& all) {
    Layer other = layer;
    other.density_kg_m3 = density_kg_m3.value_or(layer.density_kg_m3);
    other.c_s_m_s = c_s_m_s.value_or(layer.c_s_m_s);
    const Material around = material_of(layer), here = material_of(other);
    if (here.mu_Pa > all.stiffness * around.mu_Pa)
        all = {here.mu_Pa / around.mu_Pa, here.density_kg_m3 / around.density_kg_m3};
}

/// Calls use(layer) for all layers between two depths.
template <class Use>
void each_layer(const Medium& medium, double top_m, double bottom_m, const Use& use) {
    double layer_top_m = 0.0;
    for (const Layer& layer : medium.layers) {
        const bool endless = medium.base == Base::half_space && &layer == &medium.layers.back();
        const double layer_bottom_m = layer_top_m + layer.thickness_m;
        if ((top_m < layer_bottom_m || endless) && bottom_m > layer_top_m) use(layer);
        layer_top_m = layer_bottom_m;
    }
}

void add_cap(const std::string& what, const Contrast& all, double cap,
             std::vector<engines::Choice>& choices) {
    if (all.stiffness <= cap * (1.0 + 1e-12)) return;
    choices.push_back(
        {"solver.spectral.contrast_cap",
         fmt::format("{}: shear stiffness {:.3g} times that of the surrounding layer "
                     "is capped at {:.4g} times (contrast_cap): it reflects {:.3f} of "
                     "a shear wave's amplitude instead of {:.3f}",
                     what, all.stiffness, cap, shear_reflection(cap, all.density),
                     shear_reflection(all.stiffness, all.density))});
}

std::string rigid_note(const Case& c, std::size_t i, const std::string& why) {
    const Body& body = c.scene.medium.bodies[i];
    const std::string rest = reason_of_rest(body, c.scene.medium, c.domain);
    return fmt::format("medium.body[{}] is rigid{} and {}: {}", i + 1, why,
                       rest.empty() ? "moves with its mass" : rest,
                       is_below_rigid_layer(body, c.scene.medium, c.domain)
                           ? "no effect on the field"
                       : endless_along(body, c.domain) == Endless::both
                           ? "the computed medium ends at its top"
                           : "one additional background solve per step, no cap on its stiffness");
}

std::string elastic_note(const Case& c, std::size_t i, const std::string& why) {
    const Body& body = c.scene.medium.bodies[i];
    std::string note = fmt::format("medium.body[{}] is elastic", i + 1);
    if (body.c_s_m_s)
        note += fmt::format(", {:.3g} times as stiff as its surroundings",
                            stiffness_contrast(body, c.scene.medium));
    return note + why;
}

/// Time step and elements, with the errors if they have been estimated.
std::vector<std::string> discretisation_notes(const TimeStep& time, const DepthMesh& mesh,
                                              const std::optional<ProbedErrors>& errors) {
    double longest_m = 0.0;
    for (std::size_t e = 0; e < mesh.elements(); ++e)
        longest_m = std::max(longest_m, mesh.length_m(e));
    std::vector<std::string> notes = {
        time.why, fmt::format("{} element{} of degree {} over depth, {:.3g} mm long at the "
                              "surface and at most {:.3g} mm long",
                              mesh.elements(), mesh.elements() == 1 ? "" : "s", mesh.degree,
                              1e3 * mesh.length_m(0), 1e3 * longest_m)};
    if (mesh.bottom)
        notes.push_back(fmt::format(
            "the half-space consists of {:.3g} mm of the medium and an absorber of {:.3g} mm, "
            "designed for shear wavelengths up to {:.3g} mm{}",
            1e3 * mesh.bottom->clear_m, 1e3 * mesh.bottom->depth_m, 1e3 * mesh.bottom->longest_m,
            errors ? fmt::format(" (estimated error {:.2g})", errors->absorber) : ""));
    if (!errors)
        notes.emplace_back("the error of steps and elements is estimated when the case runs");
    else
        notes.push_back(
            fmt::format("step{} cause an estimated error of {:.2g} in the surface field "
                        "(relative L2), and of up to {:.2g} of its maximum near the focus",
                        mesh.bottom ? ", elements and absorber" : " and elements", errors->norm,
                        errors->maximum));
    return notes;
}

std::string sponge_note(const Case& c, const SpongePlan& sponge) {
    const double width_m = c.domain.sponge_m;
    const double wave_m = longest_wave_m(c.scene.load, edge_speed_m_s(c.scene.medium, width_m));
    return fmt::format("the sponge of {:.3g} mm acts every {} step{} on {} x {} points and returns "
                       "{:.2g} % of the energy of the longest waves ({:.3g} mm)",
                       1e3 * width_m, sponge.every, sponge.every == 1 ? "" : "s", sponge.nx,
                       sponge.ny, 100.0 * returned_energy(wave_m, width_m), 1e3 * wave_m);
}

std::string variation_note(const VariationPlan& v, const DepthMesh& mesh) {
    const std::string where = v.box
                                  ? fmt::format("in a box of {} x {} points", v.box->nx, v.box->ny)
                                  : "on complete planes";
    return fmt::format(
        "{:.0f} of {} strain points vary laterally: {}; {}", v.points,
        mesh.elements() * static_cast<std::size_t>(mesh.degree + 1),
        v.iterates ? "conjugate gradients " + where : "one background solve per step", v.why);
}

} // namespace

std::vector<Remark> accuracy_warnings(const Case& c, const ProbedErrors& errors) {
    const auto& options = std::get<SpectralOptions>(c.solver);
    if (errors.norm <= options.accuracy) return {};
    const bool by_absorber = errors.absorber > 0.5 * errors.norm;
    return {
        {Severity::warning,
         by_absorber           ? "solver.spectral.absorbing_depth_mm"
         : options.time_step_s ? "solver.spectral.time_step_us"
                               : "solver.spectral.accuracy",
         fmt::format("the estimated relative L2 error of the surface field, {:.1e}, exceeds the "
                     "accuracy of {:.1e}; {}",
                     errors.norm, options.accuracy,
                     by_absorber           ? "use a deeper absorber, or a wider domain"
                     : options.time_step_s ? "remove this key, or use a shorter step"
                                           : "specify a shorter solver.spectral.time_step_us")}};
}

std::vector<std::string> body_notes(const RigidPlan& plan) {
    std::vector<std::string> notes;
    for (std::size_t i = 0; i < plan.reasons.size(); ++i) {
        const bool is_rigid = plan.marked.scene.medium.bodies[i].rigid;
        notes.push_back((is_rigid ? rigid_note : elastic_note)(plan.marked, i, plan.reasons[i]));
    }
    return notes;
}

std::vector<engines::Choice> cap_choices(const Case& c) {
    const double cap = std::get<SpectralOptions>(c.solver).contrast_cap;
    const Medium& medium = c.scene.medium;
    std::vector<engines::Choice> choices;
    for (std::size_t i = 0; i < medium.bodies.size(); ++i) {
        const Body& body = medium.bodies[i];
        if (body.rigid) continue;
        const Bounds box = bounds(body);
        Contrast all;
        each_layer(medium, box.low_m.z, box.high_m.z,
                   [&](const Layer& layer) { add(layer, body.c_s_m_s, body.density_kg_m3, all); });
        add_cap(fmt::format("medium.body[{}]", i + 1), all, cap, choices);
    }
    if (const MaterialMap* map = medium.map.get()) {
        const DepthRange range = depths(*map);
        const auto value = [](const std::vector<double>& values, std::size_t i) {
            return values.empty() ? std::nullopt : std::optional(values[i]);
        };
        Contrast all;
        each_layer(medium, range.top_m, range.bottom_m, [&](const Layer& layer) {
            for (std::size_t i = 0; i < std::max(map->c_s_m_s.size(), map->density_kg_m3.size());
                 ++i)
                add(layer, value(map->c_s_m_s, i), value(map->density_kg_m3, i), all);
        });
        add_cap("medium.map", all, cap, choices);
    }
    return choices;
}

std::vector<std::string> SpectralPlan::notes(const std::optional<ProbedErrors>& errors,
                                             const VariationPlan& varying) const {
    std::vector<std::string> all = discretisation_notes(time, mesh, errors);
    if (const SpongePlan acting = sponge(varying); acting.every > 0)
        all.push_back(sponge_note(rigid.c, acting));
    for (const auto& more : {body_notes(rigid), engines::notes_of(cap_choices(rigid.marked))})
        all.insert(all.end(), more.begin(), more.end());
    if (!rigid.why.empty()) all.push_back(rigid.why);
    if (varying.points > 0.0) all.push_back(variation_note(varying, mesh));
    return all;
}

} // namespace shearwake::spectral
