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

/// Difference of an inclusion from the layers around it.
struct Difference {
    double contrast = 1.0; // maximum ratio of shear stiffnesses
    double dense = 1.0;    // ratio of densities at the maximum contrast
    bool density = false, viscosity = false;
};

/// Adds one material of an inclusion, given as a Body or a MapSample.
void add(const Layer& layer, const auto& given, Difference& all) {
    Layer other = layer;
    other.density_kg_m3 = given.density_kg_m3.value_or(layer.density_kg_m3);
    other.c_s_m_s = given.c_s_m_s.value_or(layer.c_s_m_s);
    const Material around = material_of(layer), here = material_of(other);
    if (here.mu_Pa > all.contrast * around.mu_Pa) {
        all.contrast = here.mu_Pa / around.mu_Pa;
        all.dense = here.density_kg_m3 / around.density_kg_m3;
    }
    all.density |= here.density_kg_m3 != around.density_kg_m3;
    all.viscosity |= given.viscosity_Pa_s.value_or(around.viscosity_Pa_s) != around.viscosity_Pa_s;
}

std::optional<double> value_at(const std::vector<double>& values, std::size_t i) {
    return values.empty() ? std::nullopt : std::optional(values[i]);
}

/// Calls `add_layer` for all layers between the two depths.
template <class Add>
Difference difference(const Medium& medium, double top_m, double bottom_m, const Add& add_layer) {
    Difference all;
    double layer_top_m = 0.0;
    for (const Layer& layer : medium.layers) {
        const bool endless = medium.base == Base::half_space && &layer == &medium.layers.back();
        const double layer_bottom_m = layer_top_m + layer.thickness_m;
        if ((top_m < layer_bottom_m || endless) && bottom_m > layer_top_m) add_layer(layer, all);
        layer_top_m = layer_bottom_m;
    }
    return all;
}

void add_notes(const std::string& what, const Difference& d, double cap,
               std::vector<engines::Choice>& notes) {
    if (d.contrast > cap * (1.0 + 1e-12))
        notes.push_back({"solver.spectral.contrast_cap",
                         fmt::format("{}: shear stiffness {:.3g} times that of the surrounding "
                                     "layer is capped at {:.4g} times (contrast_cap): it reflects "
                                     "{:.3f} of a shear wave's amplitude instead of {:.3f}",
                                     what, d.contrast, cap, shear_reflection(cap, d.dense),
                                     shear_reflection(d.contrast, d.dense))});
    if (d.density || d.viscosity)
        notes.push_back(
            {"",
             fmt::format("{} differs from the layers in {}: every step needs an iterative solve",
                         what, d.density ? "density" : "viscosity")});
}

std::string rigid_note(const Case& given, const Case& c, std::size_t i) {
    const Body& body = c.scene().medium.bodies[i];
    std::string why;
    if (!given.scene().medium.bodies[i].rigid)
        why = fmt::format(
            " because it is {:.3g} times stiffer than its surroundings (rigid_above = {:.4g})",
            stiffness_contrast(body, c.scene().medium),
            std::get<SpectralOptions>(c.solver).rigid_above);
    const std::string rest = reason_of_rest(body, c.scene().medium, c.domain);
    return fmt::format("medium.body[{}] is rigid{} and {}: {}", i + 1, why,
                       rest.empty() ? "moves with its mass" : rest,
                       is_below_rigid_layer(body, c.scene().medium, c.domain)
                           ? "no effect on the field"
                           : "one additional background solve per step, no cap on its stiffness");
}

std::string elastic_note(const Case& c, std::size_t i) {
    const Body& body = c.scene().medium.bodies[i];
    std::string note = fmt::format("medium.body[{}] is elastic", i + 1);
    if (body.c_s_m_s)
        note += fmt::format(", {:.3g} times as stiff as its surroundings",
                            stiffness_contrast(body, c.scene().medium));
    if (is_stiff_enough(body, c))
        note += fmt::format(". It is not treated as rigid: {}", obstacle(c, i));
    return note;
}

} // namespace

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

std::vector<std::string> edge_notes(const Case& c) {
    const double width_m = c.domain.sponge_m;
    if (!(width_m > 0.0)) return {}; // the checks of the case warn if this matters
    const double wave_m = longest_wave_m(c.scene().load, edge_speed_m_s(c.scene().medium, width_m));
    return {fmt::format("the sponge of {:.3g} mm returns {:.2g} % of the energy of the longest "
                        "waves ({:.3g} mm)",
                        1e3 * width_m, 100.0 * returned_energy(wave_m, width_m), 1e3 * wave_m)};
}

std::vector<std::string> body_notes(const Case& given) {
    const Case c = with_rigid_bodies(given);
    std::vector<std::string> notes;
    for (std::size_t i = 0; i < c.scene().medium.bodies.size(); ++i)
        notes.push_back(c.scene().medium.bodies[i].rigid ? rigid_note(given, c, i)
                                                         : elastic_note(c, i));
    return notes;
}

std::vector<engines::Choice> variation_choices(const Case& c, const SpectralOptions& options) {
    std::vector<engines::Choice> notes;
    for (std::size_t i = 0; i < c.scene().medium.bodies.size(); ++i) {
        const Body& body = c.scene().medium.bodies[i];
        if (body.rigid) continue;
        const Bounds box = bounds(body);
        add_notes(fmt::format("medium.body[{}]", i + 1),
                  difference(c.scene().medium, box.low_m.z, box.high_m.z,
                             [&](const Layer& layer, Difference& all) { add(layer, body, all); }),
                  options.contrast_cap, notes);
    }
    if (!c.scene().medium.map) return notes;
    const MaterialMap& map = *c.scene().medium.map;
    const DepthRange range = depths(map);
    const auto points = static_cast<std::size_t>(map.counts[0] * map.counts[1] * map.counts[2]);
    add_notes("medium.map",
              difference(c.scene().medium, range.top_m, range.bottom_m,
                         [&](const Layer& layer, Difference& all) {
                             for (std::size_t i = 0; i < points; ++i)
                                 add(layer,
                                     MapSample{.c_s_m_s = value_at(map.c_s_m_s, i),
                                               .c_p_m_s = {},
                                               .density_kg_m3 = value_at(map.density_kg_m3, i),
                                               .viscosity_Pa_s = value_at(map.viscosity_Pa_s, i)},
                                     all);
                         }),
              options.contrast_cap, notes);
    return notes;
}

} // namespace shearwake::spectral
