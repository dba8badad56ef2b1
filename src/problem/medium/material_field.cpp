// SPDX-License-Identifier: BSD-3-Clause
#include "problem/medium/material_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace shearwake {

namespace {

/// A material as given in job files and maps.
struct Properties {
    double density_kg_m3, c_p_m_s, c_s_m_s, viscosity_Pa_s;
};

Properties properties_of(const Layer& layer) {
    return {layer.density_kg_m3, layer.c_p_m_s, layer.c_s_m_s,
            newtonian_viscosity_Pa_s(layer.loss).value_or(0.0)};
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

CellMaterial uniform(const Material& m) {
    return {m, m.mu_Pa, m.viscosity_Pa_s, {}};
}

double mean(double share, double a, double b) {
    return a + share * (b - a); // exactly a if b is equal
}

Material mixed(const Material& a, const Material& b, double share) {
    return {mean(share, a.density_kg_m3, b.density_kg_m3), mean(share, a.lambda_Pa, b.lambda_Pa),
            mean(share, a.mu_Pa, b.mu_Pa), mean(share, a.viscosity_Pa_s, b.viscosity_Pa_s)};
}

struct Part {
    CellMaterial material;
    double share;
};

/// The self-consistent estimate at growth s, the root mu of the sum of share (mu_i - mu) / (mu_i +
/// 1.5 mu) with mu_i + s viscosity_i for mu_i, which decreases with mu.
double effective_mu_Pa(std::span<const Part> parts, double s) {
    double low_Pa = std::numeric_limits<double>::infinity(), high_Pa = 0.0;
    for (const auto& [m, share] : parts) {
        low_Pa = std::min(low_Pa, m.mu_Pa + s * m.viscosity_Pa_s);
        high_Pa = std::max(high_Pa, m.mu_Pa + s * m.viscosity_Pa_s);
    }
    for (int i = 0; i < 50; ++i) { // contrast times 2^-50
        const double mu_Pa = 0.5 * (low_Pa + high_Pa);
        double sum = 0.0;
        for (const auto& [m, share] : parts) {
            const double own_Pa = m.mu_Pa + s * m.viscosity_Pa_s;
            sum += share * (own_Pa - mu_Pa) / (own_Pa + 1.5 * mu_Pa);
        }
        (sum > 0.0 ? low_Pa : high_Pa) = mu_Pa;
    }
    return 0.5 * (low_Pa + high_Pa);
}

double across_Pa(std::span<const Part> parts, double s) {
    double sum = 0.0;
    for (const auto& [m, share] : parts)
        sum += share / (m.mu_across_Pa + s * m.viscosity_across_Pa_s);
    return 1.0 / sum;
}

/// Shear moduli and viscosities of a laminate that contains the means. See material_of_cell.
void set_shear(CellMaterial& m, std::span<const Part> parts, const Material& around) {
    bool stiffer = false, softer = false, more_viscous = false;
    double loss_s = 0.0;
    for (const auto& [part, share] : parts) {
        stiffer |= part.mu_Pa > around.mu_Pa;
        softer |= part.mu_Pa < around.mu_Pa;
        more_viscous |= part.viscosity_Pa_s > around.viscosity_Pa_s;
        loss_s = std::max({loss_s, part.viscosity_Pa_s / part.mu_Pa,
                           part.viscosity_across_Pa_s / part.mu_across_Pa});
    }
    m.mu_across_Pa = across_Pa(parts, 0.0);
    if (stiffer) m.mu_Pa = effective_mu_Pa(parts, 0.0);
    if (loss_s == 0.0) return;
    const double s = 0.25 / loss_s;
    m.viscosity_across_Pa_s = (across_Pa(parts, s) - m.mu_across_Pa) / s;
    if (more_viscous && !softer) m.viscosity_Pa_s = (effective_mu_Pa(parts, s) - m.mu_Pa) / s;
}

/// See material_of_cell. `slope` is a multiple of the normal.
CellMaterial laminated(const CellMaterial& a, const Material& b, double share, Vec3 slope) {
    const double p_a = a.lambda_Pa + 2.0 * a.mu_Pa, p_b = b.lambda_Pa + 2.0 * b.mu_Pa;
    CellMaterial m{mixed(a, b, share), 0.0, 0.0, a.normal + slope};
    m.lambda_Pa =
        mean(share, a.lambda_Pa / p_a, b.lambda_Pa / p_b) / mean(share, 1.0 / p_a, 1.0 / p_b);
    if (a.mu_across_Pa == 0.0 || b.mu_Pa == 0.0) return m; // next to a fluid
    set_shear(m, std::array{Part{a, 1.0 - share}, Part{uniform(b), share}}, a);
    return m;
}

/// The gradient of the fraction of a body, times a relative contrast: of several surfaces in a
/// cell, that of the greatest contrast determines the normal.
Vec3 weighted_normal(const Body& body, Vec3 centre_m, Vec3 size_m, const Material& a,
                     const Material& b) {
    const auto contrast = [](double x, double y) {
        return x + y > 0.0 ? std::abs(x - y) / (x + y) : 0.0;
    };
    const auto slope = [&](Vec3 step) {
        return (volume_fraction(body, centre_m + step, size_m) -
                volume_fraction(body, centre_m - step, size_m)) /
               norm(step);
    };
    constexpr double step = 0.25; // of the cell: within the reach of both of its neighbours
    return (contrast(a.mu_Pa, b.mu_Pa) + contrast(a.viscosity_Pa_s, b.viscosity_Pa_s)) *
           Vec3{slope({step * size_m.x, 0.0, 0.0}), slope({0.0, step * size_m.y, 0.0}),
                slope({0.0, 0.0, step * size_m.z})};
}

/// A cell of a map, divided into `along` points along each axis.
struct MapCell {
    static constexpr int along = 4;
    const MaterialMap& map;
    const Properties& layer;
    Vec3 centre_m, size_m;

    Vec3 offset_m(int i, int j, int k) const {
        const auto place = [](int n) { return (n + 0.5) / along - 0.5; };
        return {place(i) * size_m.x, place(j) * size_m.y, place(k) * size_m.z};
    }
    /// Calls `use` with the shares and materials of the neighbours of a position in the map.
    void each_part(Vec3 at_m, const auto& use) const {
        each_neighbour(map, at_m, [&](double share, const MapSample& value) {
            use(share, material_of(with_given(layer, value)));
        });
    }
    /// Whether the spacing of the map is so coarse that its interpolation is resolved.
    bool resolves_map() const {
        constexpr double coarse = 1.5; // cells between points that interpolation resolves
        return std::max({map.spacing_m.x, map.spacing_m.y, map.spacing_m.z}) >
               coarse * std::max(size_m.x, size_m.y);
    }
};

/// The least and the greatest shear properties of some materials.
struct ShearRange {
    Material least, greatest;

    void widen(const Material& m) {
        least.mu_Pa = std::min(least.mu_Pa, m.mu_Pa);
        least.viscosity_Pa_s = std::min(least.viscosity_Pa_s, m.viscosity_Pa_s);
        greatest.mu_Pa = std::max(greatest.mu_Pa, m.mu_Pa);
        greatest.viscosity_Pa_s = std::max(greatest.viscosity_Pa_s, m.viscosity_Pa_s);
    }
    /// Whether there is an interface between the materials.
    bool has_interface() const {
        constexpr double interface = 1.2; // below, the means differ by less than 1 %
        return greatest.mu_Pa > interface * least.mu_Pa ||
               greatest.viscosity_Pa_s > interface * least.viscosity_Pa_s;
    }
};

/// See material_of_cell.
CellMaterial cell_of_map(const MapCell& cell) {
    constexpr int along = MapCell::along, last = along - 1;
    constexpr double of_point = 1.0 / (along * along * along);
    const Material centre = material_of(with_given(cell.layer, sample(cell.map, cell.centre_m)));
    if (cell.resolves_map()) return uniform(centre);
    ShearRange range{centre, centre};
    for (const int i : {0, last})
        for (const int j : {0, last})
            for (const int k : {0, last})
                cell.each_part(cell.centre_m + cell.offset_m(i, j, k),
                               [&](double, const Material& part) { range.widen(part); });
    if (!range.has_interface()) return uniform(centre);

    std::vector<Part> parts;
    CellMaterial m;
    double per_p = 0.0, lambda_per_p = 0.0;
    const auto add = [&](Vec3 slope, double share, const Material& part) {
        parts.push_back({uniform(part), share});
        range.widen(part);
        const double p = part.lambda_Pa + 2.0 * part.mu_Pa;
        m.density_kg_m3 += share * part.density_kg_m3;
        m.mu_Pa += share * part.mu_Pa;
        m.viscosity_Pa_s += share * part.viscosity_Pa_s;
        per_p += share / p;
        lambda_per_p += share * part.lambda_Pa / p;
        const Material& greatest = range.greatest;
        const double value =
            part.mu_Pa / greatest.mu_Pa +
            (greatest.viscosity_Pa_s > 0.0 ? part.viscosity_Pa_s / greatest.viscosity_Pa_s : 0.0);
        m.normal = m.normal + (share * value) * slope;
    };
    const Vec3 size_m = cell.size_m;
    for (int i = 0; i < along; ++i)
        for (int j = 0; j < along; ++j)
            for (int k = 0; k < along; ++k) {
                const Vec3 place_m = cell.offset_m(i, j, k);
                const Vec3 slope{place_m.x / (size_m.x * size_m.x),
                                 place_m.y / (size_m.y * size_m.y),
                                 place_m.z / (size_m.z * size_m.z)};
                cell.each_part(cell.centre_m + place_m, [&](double weight, const Material& part) {
                    add(slope, of_point * weight, part);
                });
            }
    m.lambda_Pa = lambda_per_p / per_p;
    if (range.least.mu_Pa == 0.0) return uniform(m); // next to a fluid
    set_shear(m, parts, material_of(cell.layer));
    return m;
}

} // namespace

Material material_of(const Layer& layer) {
    return material_of(properties_of(layer));
}

CellMaterial material_of_cell(const Medium& medium, std::size_t layer, Vec3 centre_m, Vec3 size_m) {
    Properties around = properties_of(medium.layers.at(layer));
    CellMaterial material = uniform(material_of(around));
    if (medium.map) {
        if (norm(size_m) > 0.0) material = cell_of_map({*medium.map, around, centre_m, size_m});
        around = with_given(around, sample(*medium.map, centre_m));
        if (norm(size_m) == 0.0) material = uniform(material_of(around));
    }
    for (const Body& body : medium.bodies) {
        const double share = volume_fraction(body, centre_m, size_m);
        if (!(share > 0.0)) continue;
        const Material own = material_of(with_given(around, body));
        if (share == 1.0)
            material = uniform(own);
        else if (norm(size_m) > 0.0)
            material = laminated(material, own, share,
                                 weighted_normal(body, centre_m, size_m, material, own));
        else
            material = uniform(mixed(material, own, share));
    }
    if (const double length = norm(material.normal); length > 0.0)
        material.normal = (1.0 / length) * material.normal;
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

namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

struct Interval {
    double low, high;
};

/// The points of the map along one axis that influence an interval: those inside it and their
/// neighbours.
struct Points {
    std::ptrdiff_t first, end;
    bool cover; // whether they cover the whole interval
};

Points points_in(Interval wanted, double origin, double spacing, std::ptrdiff_t count) {
    if (spacing == 0.0) return {0, count, true};
    const double last = static_cast<double>(count - 1);
    const double low = (wanted.low - origin) / spacing, high = (wanted.high - origin) / spacing;
    if (high < -0.5 || low > last + 0.5) return {0, 0, false};
    const auto clamped = [&](double place) {
        return static_cast<std::ptrdiff_t>(std::clamp(place, 0.0, last));
    };
    return {clamped(std::floor(low)), clamped(std::ceil(high)) + 1,
            low >= -0.5 && high <= last + 0.5};
}

} // namespace

bool has_positive_bulk_modulus(const Speeds& speeds) {
    return 3.0 * speeds.c_p_m_s * speeds.c_p_m_s > 4.0 * speeds.c_s_m_s * speeds.c_s_m_s;
}

DepthRange depths(const Medium& medium, std::size_t layer) {
    double top_m = 0.0;
    for (std::size_t i = 0; i < layer; ++i)
        top_m += medium.layers[i].thickness_m;
    const bool endless = medium.base == Base::half_space && layer + 1 == medium.layers.size();
    return {top_m, endless ? unlimited : top_m + medium.layers[layer].thickness_m};
}

Speeds softest_against_pressure(const Medium& medium, std::size_t layer, const Body* body) {
    Speeds own{medium.layers[layer].c_p_m_s, medium.layers[layer].c_s_m_s};
    if (body) own = {body->c_p_m_s.value_or(own.c_p_m_s), body->c_s_m_s.value_or(own.c_s_m_s)};
    if (!medium.map) return own;
    const MaterialMap& map = *medium.map;
    const bool maps_c_p = !map.c_p_m_s.empty() && !(body && body->c_p_m_s);
    const bool maps_c_s = !map.c_s_m_s.empty() && !(body && body->c_s_m_s);
    if (!maps_c_p && !maps_c_s) return own;

    const Bounds box =
        body ? bounds(*body)
             : Bounds{{-unlimited, -unlimited, -unlimited}, {unlimited, unlimited, unlimited}};
    const DepthRange depth = depths(medium, layer);
    const Interval z{std::max(box.low_m.z, depth.top_m), std::min(box.high_m.z, depth.bottom_m)};
    const std::array<Points, 3> in{
        points_in({box.low_m.x, box.high_m.x}, map.origin_m.x, map.spacing_m.x, map.counts[0]),
        points_in({box.low_m.y, box.high_m.y}, map.origin_m.y, map.spacing_m.y, map.counts[1]),
        points_in(z, map.origin_m.z, map.spacing_m.z, map.counts[2])};
    const bool covered = in[0].cover && in[1].cover && in[2].cover;
    Speeds softest = covered ? Speeds{unlimited, 1.0} : own;
    for (std::ptrdiff_t i = in[0].first; i < in[0].end; ++i)
        for (std::ptrdiff_t j = in[1].first; j < in[1].end; ++j)
            for (std::ptrdiff_t k = in[2].first; k < in[2].end; ++k) {
                const auto at =
                    static_cast<std::size_t>((i * map.counts[1] + j) * map.counts[2] + k);
                const Speeds here{maps_c_p ? map.c_p_m_s[at] : own.c_p_m_s,
                                  maps_c_s ? map.c_s_m_s[at] : own.c_s_m_s};
                if (here.c_p_m_s * softest.c_s_m_s < softest.c_p_m_s * here.c_s_m_s) softest = here;
            }
    return softest;
}

} // namespace shearwake
