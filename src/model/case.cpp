#include "model/case.hpp"

#include "base/hash.hpp"
#include "base/overloaded.hpp"
#include "model/afferents_text.hpp"
#include "model/load_text.hpp"

namespace shearwake {
namespace {

void put_loss(TomlText& t, const ShearLoss& loss) {
    std::visit(overloaded{
                   [&](const Lossless&) { t.put("loss", "none"); },
                   [&](const KelvinVoigt& law) {
                       t.put("loss", "kelvin-voigt");
                       t.put("viscosity_Pa_s", law.viscosity_Pa_s);
                   },
                   [&](const FractionalKelvinVoigt& law) {
                       t.put("loss", "fractional");
                       t.put("tau_s", law.tau_s);
                       t.put("exponent", law.exponent);
                   },
                   [&](const StandardLinearSolid& law) {
                       t.put("loss", "standard-linear");
                       t.put("tau_s", law.tau_s);
                       t.put("strength", law.strength);
                   },
               },
               loss);
}

void put_body(TomlText& t, const Body& body) {
    t.element("medium.body");
    t.put("name", body.name);
    std::visit(overloaded{
                   [&](const Ellipsoid& shape) {
                       t.put("shape", "ellipsoid");
                       t.put("semi_axes_m", shape.semi_axes_m);
                   },
                   [&](const Cylinder& shape) {
                       const bool is_vertical = shape.axis == CylinderAxis::vertical;
                       t.put("shape", "cylinder");
                       t.put("axis", is_vertical ? "vertical" : "horizontal");
                       t.put("radius_m", shape.radius_m);
                       t.put("length_m", shape.is_endless() ? 0.0 : shape.length_m);
                       t.put("azimuth_deg", is_vertical ? 0.0 : shape.azimuth_deg);
                   },
                   [&](const Box& shape) {
                       t.put("shape", "box");
                       t.put("size_m", shape.size_m);
                   },
               },
               body.shape);
    t.put("centre_m", body.centre_m);
    t.put("edge_m", body.edge_m);
    t.put("density_kg_m3", body.density_kg_m3);
    t.put("c_p_m_s", body.c_p_m_s);
    t.put("c_s_m_s", body.c_s_m_s);
    t.put("viscosity_Pa_s", body.viscosity_Pa_s);
}

void put_medium(TomlText& t, const Medium& medium) {
    t.table("medium");
    t.put("base", medium.base == Base::rigid ? "rigid" : "half-space");
    if (medium.map) t.put("map", medium.map->content_hash); // the file may have any name
    for (const Layer& layer : medium.layers) {
        t.element("medium.layer");
        t.put("name", layer.name);
        t.put("thickness_m", layer.thickness_m);
        t.put("density_kg_m3", layer.density_kg_m3);
        t.put("c_p_m_s", layer.c_p_m_s);
        t.put("c_s_m_s", layer.c_s_m_s);
        put_loss(t, layer.loss);
    }
    for (const Body& body : medium.bodies)
        put_body(t, body);
}

void put_record(TomlText& t, const RecordOptions& record) {
    t.table("record");
    std::vector<double> xs, ys;
    for (const Vec2& p : record.traces_m) {
        xs.push_back(p.x);
        ys.push_back(p.y);
    }
    t.put("traces_x_m", xs);
    t.put("traces_y_m", ys);
    t.put("snapshots_s", record.snapshots_s);
    t.put_flag("frames", record.frames);
    if (record.volumes_s.empty()) return; // as before there were volumes: ids stay
    std::vector<std::string> fields;
    for (const VolumeField field : record.volume_fields)
        fields.push_back(name_of(field));
    t.put("volumes_s", record.volumes_s);
    t.put("volume_fields", fields);
}

void put_solver(TomlText& t, const SolverOptions& solver) {
    t.table("solver");
    t.put("engine", engine_name(solver));
    std::visit(overloaded{
                   [&](const LayeredOptions& o) {
                       if (o.time_step_s) t.put("time_step_s", *o.time_step_s);
                       t.put("window_factor", o.window_factor);
                       t.put("wrap_suppression", o.wrap_suppression);
                       t.put("interpolation_tolerance", o.interpolation_tolerance);
                   },
                   [&](const SpectralOptions& o) {
                       if (o.time_step_s) // decides alone
                           t.put("time_step_s", *o.time_step_s);
                       else
                           t.put("accuracy", o.accuracy);
                       t.put("degree", static_cast<std::ptrdiff_t>(o.degree));
                       t.put("longest_element_m", o.longest_element_m);
                       if (o.absorbing_depth_m > 0.0)
                           t.put("absorbing_depth_m", o.absorbing_depth_m);
                       t.put("method", o.method == SpectralMethod::automatic   ? "auto"
                                       : o.method == SpectralMethod::one_solve ? "one-solve"
                                                                               : "iterative");
                       t.put("residual", o.residual);
                       t.put("contrast_cap", o.contrast_cap);
                   },
                   [&](const PstdOptions& o) {
                       if (o.study) t.put("study", (*o.study).content_hash); // any name
                       if (o.time_step_s) t.put("time_step_s", *o.time_step_s);
                       t.put("c_p_over_c_s", o.c_p_over_c_s);
                       t.put("top", o.top == PstdTop::nothing     ? "void"
                                    : o.top == PstdTop::continued ? "continued"
                                                                  : "fluid");
                       if (o.top == PstdTop::fluid) {
                           t.put("fluid_density_kg_m3", o.fluid_density_kg_m3);
                           t.put("fluid_c_p_m_s", o.fluid_c_p_m_s);
                       }
                       t.put("load", o.load == PstdLoad::traction ? "traction" : "displacement");
                       if (o.load == PstdLoad::displacement)
                           t.put("displacement_m", o.displacement_m);
                       if (o.depth_m > 0.0) t.put("depth_m", o.depth_m);
                       t.put("absorbing_points", static_cast<std::ptrdiff_t>(o.absorbing_points));
                       t.put("absorbing_strength", o.absorbing_strength);
                       t.put_flag("absorbing_edges", o.absorbing_edges);
                       t.put("precision",
                             o.precision == Precision::double_precision ? "double" : "single");
                   },
               },
               solver);
}

} // namespace

std::vector<double> stress_depths_m(const Case& c) {
    std::vector<double> depths_m;
    if (c.afferents && std::holds_alternative<StressInput>(c.afferents->input))
        for (const AfferentClass kind : all_classes) // ascending
            depths_m.push_back(receptor_depth_m(kind));
    return depths_m;
}

std::string engine_name(const SolverOptions& solver) {
    return std::visit(overloaded{
                          [](const LayeredOptions&) { return std::string("layered"); },
                          [](const SpectralOptions&) { return std::string("spectral"); },
                          [](const PstdOptions&) { return std::string("pstd"); },
                      },
                      solver);
}

std::vector<std::string> engine_names() {
    return []<std::size_t... i>(std::index_sequence<i...>) {
        return std::vector{engine_name(std::variant_alternative_t<i, SolverOptions>{})...};
    }
    (std::make_index_sequence<std::variant_size_v<SolverOptions>>());
}

std::ptrdiff_t good_even_length(std::ptrdiff_t n) {
    for (std::ptrdiff_t length = n + n % 2;; length += 2) {
        std::ptrdiff_t rest = length;
        for (const std::ptrdiff_t prime : {2, 3, 5, 7})
            while (rest > 1 && rest % prime == 0)
                rest /= prime;
        if (rest <= 1) return length;
    }
}

std::string canonical_text(const Case& c) {
    TomlText t;
    put_medium(t, c.medium);
    put_load(t, c.load);
    t.table("domain");
    t.put("nx", c.domain.nx);
    t.put("ny", c.domain.ny);
    t.put("spacing_m", c.domain.spacing_m);
    t.put("sponge_m", c.domain.sponge_m);
    t.table("time");
    t.put("frames", c.time.frames);
    t.put("interval_s", c.time.interval_s);
    t.table("measure");
    t.put("at_s", c.measure.at_s);
    t.put("settled_after_s", c.measure.settled_after_s);
    t.put("focal_radius_m", c.measure.focal_radius_m);
    t.put("depths_m", c.measure.depths_m);
    if (!c.measure.bands.empty()) { // as before where there are none
        std::vector<double> edges_Hz;
        for (const FrequencyBand& band : c.measure.bands)
            edges_Hz.insert(edges_Hz.end(), {band.low_Hz, band.high_Hz});
        t.put("bands_Hz", edges_Hz);
    }
    put_record(t, c.record);
    put_solver(t, c.solver);
    if (c.afferents) put_afferents(t, *c.afferents); // as before where there are none
    return t.take();
}

std::string case_id(const Case& c) {
    return hex(stable_hash(canonical_text(c)));
}

} // namespace shearwake
