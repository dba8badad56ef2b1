// SPDX-License-Identifier: BSD-3-Clause
#include "problem/medium/material_field.hpp"

namespace shearwake {
namespace {

/// A material as given in job files and maps.
struct Properties {
    double density_kg_m3, c_p_m_s, c_s_m_s, viscosity_Pa_s;
};

Properties properties_of(const Layer& layer) {
    const auto* law = std::get_if<KelvinVoigt>(&layer.loss);
    return {layer.density_kg_m3, layer.c_p_m_s, layer.c_s_m_s, law ? law->viscosity_Pa_s : 0.0};
}

/// `given` is a Body or a MapSample.
Properties with_given(const Properties& around, const auto& given) {
    return {given.density_kg_m3.value_or(around.density_kg_m3),
            given.c_p_m_s.value_or(around.c_p_m_s), given.c_s_m_s.value_or(around.c_s_m_s),
            given.viscosity_Pa_s.value_or(around.viscosity_Pa_s)};
}

Material material_of(const Properties& p) {
    const double mu_Pa = p.density_kg_m3 * p.c_s_m_s * p.c_s_m_s;
    return {p.density_kg_m3, p.density_kg_m3 * p.c_p_m_s * p.c_p_m_s - 2.0 * mu_Pa, mu_Pa,
            p.viscosity_Pa_s};
}

Material mixed(const Material& a, const Material& b, double share) {
    const auto mix = [share](double x, double y) { return (1.0 - share) * x + share * y; };
    return {mix(a.density_kg_m3, b.density_kg_m3), mix(a.lambda_Pa, b.lambda_Pa),
            mix(a.mu_Pa, b.mu_Pa), mix(a.viscosity_Pa_s, b.viscosity_Pa_s)};
}

} // namespace

Material material_of(const Layer& layer) {
    return material_of(properties_of(layer));
}

Material material_of_cell(const Medium& medium, std::size_t layer, Vec3 centre_m, Vec3 size_m) {
    Properties around = properties_of(medium.layers.at(layer));
    if (medium.map) around = with_given(around, sample(*medium.map, centre_m));
    Material material = material_of(around);
    for (const Body& body : medium.bodies) {
        const double share = volume_fraction(body, centre_m, size_m);
        if (share > 0.0) material = mixed(material, material_of(with_given(around, body)), share);
    }
    return material;
}

bool varies_between(const Medium& medium, double top_m, double bottom_m) {
    if (medium.map) {
        const DepthRange map = depths(*medium.map);
        if (map.top_m < bottom_m && map.bottom_m > top_m) return true;
    }
    for (const Body& body : medium.bodies) {
        const Bounds box = bounds(body);
        if (box.low_m.z < bottom_m && box.high_m.z > top_m) return true;
    }
    return false;
}

} // namespace shearwake
