// SPDX-License-Identifier: BSD-3-Clause
#include "problem/medium/material_map.hpp"

#include "base/text.hpp"

#include <algorithm>
#include <limits>

namespace shearwake {
namespace {

/// The position of a point on a uniform axis: between `index` and the next one, at the fraction
/// `share`.
struct Between {
    std::ptrdiff_t index;
    std::ptrdiff_t next;
    double share;
};

/// Tolerance at the boundary for coordinates that have rounding errors.
constexpr double forgiven = 1e-9; // of a spacing

std::optional<Between> between(double at, double origin, double spacing, std::ptrdiff_t count) {
    if (count == 1 && spacing == 0.0) return Between{0, 0, 0.0};
    const double place = (at - origin) / spacing, last = static_cast<double>(count - 1);
    if (!(place >= -0.5 - forgiven && place <= last + 0.5 + forgiven)) return std::nullopt;
    const double clamped = std::clamp(place, 0.0, last);
    const auto index = std::min(static_cast<std::ptrdiff_t>(clamped), std::max(count - 2, {}));
    return Between{index, std::min(index + 1, count - 1), clamped - static_cast<double>(index)};
}

double mix(double a, double b, double share) {
    return (1.0 - share) * a + share * b;
}

} // namespace

std::string hash_of(const MaterialMap& map) {
    // + 0.0: -0 and 0 are the same place.
    const double frame[] = {static_cast<double>(map.counts[0]),
                            static_cast<double>(map.counts[1]),
                            static_cast<double>(map.counts[2]),
                            map.origin_m.x + 0.0,
                            map.origin_m.y + 0.0,
                            map.origin_m.z + 0.0,
                            map.spacing_m.x,
                            map.spacing_m.y,
                            map.spacing_m.z};
    std::uint64_t hash = stable_hash(std::span<const double>(frame));
    const auto add = [&](std::string_view name, const std::vector<double>& values) {
        if (values.empty()) return;
        hash = stable_hash(std::span<const double>(values), stable_hash(name, hash));
    };
    add("c_s_m_s", map.c_s_m_s);
    add("c_p_m_s", map.c_p_m_s);
    add("density_kg_m3", map.density_kg_m3);
    add("viscosity_Pa_s", map.viscosity_Pa_s);
    return hex(hash);
}

MapSample sample(const MaterialMap& map, Vec3 at_m) {
    const auto x = between(at_m.x, map.origin_m.x, map.spacing_m.x, map.counts[0]);
    const auto y = between(at_m.y, map.origin_m.y, map.spacing_m.y, map.counts[1]);
    const auto z = between(at_m.z, map.origin_m.z, map.spacing_m.z, map.counts[2]);
    if (!x || !y || !z) return {};
    const auto value = [&](const std::vector<double>& values) -> std::optional<double> {
        if (values.empty()) return std::nullopt;
        const auto along_z = [&](std::ptrdiff_t i, std::ptrdiff_t j) {
            const double* row = values.data() + (i * map.counts[1] + j) * map.counts[2];
            return mix(row[z->index], row[z->next], z->share);
        };
        const auto along_y = [&](std::ptrdiff_t i) {
            return mix(along_z(i, y->index), along_z(i, y->next), y->share);
        };
        return mix(along_y(x->index), along_y(x->next), x->share);
    };
    return {value(map.c_s_m_s), value(map.c_p_m_s), value(map.density_kg_m3),
            value(map.viscosity_Pa_s)};
}

void each_neighbour(const MaterialMap& map, Vec3 at_m,
                    const std::function<void(double share, const MapSample& value)>& use) {
    const auto x = between(at_m.x, map.origin_m.x, map.spacing_m.x, map.counts[0]);
    const auto y = between(at_m.y, map.origin_m.y, map.spacing_m.y, map.counts[1]);
    const auto z = between(at_m.z, map.origin_m.z, map.spacing_m.z, map.counts[2]);
    if (!x || !y || !z) return use(1.0, {});
    for (const auto& [i, of_x] : {std::pair{x->index, 1.0 - x->share}, {x->next, x->share}})
        for (const auto& [j, of_y] : {std::pair{y->index, 1.0 - y->share}, {y->next, y->share}})
            for (const auto& [k, of_z] :
                 {std::pair{z->index, 1.0 - z->share}, {z->next, z->share}}) {
                if (!(of_x * of_y * of_z > 0.0)) continue;
                const auto at =
                    static_cast<std::size_t>((i * map.counts[1] + j) * map.counts[2] + k);
                const auto value = [at](const std::vector<double>& values) {
                    return values.empty() ? std::nullopt : std::optional(values[at]);
                };
                use(of_x * of_y * of_z, {value(map.c_s_m_s), value(map.c_p_m_s),
                                         value(map.density_kg_m3), value(map.viscosity_Pa_s)});
            }
}

DepthRange depths(const MaterialMap& map) {
    constexpr double endless_m = std::numeric_limits<double>::infinity();
    if (map.counts[2] == 1 && map.spacing_m.z == 0.0) return {-endless_m, endless_m};
    const double last_m = map.origin_m.z + static_cast<double>(map.counts[2] - 1) * map.spacing_m.z;
    return {map.origin_m.z - 0.5 * map.spacing_m.z, last_m + 0.5 * map.spacing_m.z};
}

} // namespace shearwake
