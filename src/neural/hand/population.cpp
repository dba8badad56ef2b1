// SPDX-License-Identifier: BSD-3-Clause
#include "neural/hand/population.hpp"

#include "base/hash.hpp"
#include "neural/fibre/noise.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::neural {
namespace {

/// Random number streams of one region and class.
enum Stream : std::uint32_t { shift, jitter, neuron };

/// Selects one of the neurons of the class by a number in (0, 1).
std::size_t any_row(AfferentClass kind, double u) {
    const std::size_t rows = neuron_rows(kind).size();
    return std::min(static_cast<std::size_t>(u * static_cast<double>(rows)), rows - 1);
}

std::uint64_t key_of(const std::string& place, AfferentClass kind, std::uint64_t seed) {
    return stable_hash(place + "/" + name_of(kind), stable_hash(std::to_string(seed)));
}

} // namespace

std::vector<Afferent> populate(const HandRegion& region, AfferentClass kind, std::uint64_t seed) {
    const double pitch_mm = 10.0 / std::sqrt(density_per_cm2(kind, region.kind));
    const std::uint64_t key = key_of(region.name, kind, seed);
    const auto [shift_x, shift_y] = two_uniforms(key, shift, 0);
    const Box box = bounding_box(region.outline_mm);
    // One additional pitch on every side, for points that are moved inwards.
    const auto points = [&](double length_mm) {
        return static_cast<std::uint64_t>(std::ceil(length_mm / pitch_mm)) + 2;
    };
    const std::uint64_t columns = points(box.high.x - box.low.x),
                        rows = points(box.high.y - box.low.y);
    std::vector<Afferent> afferents;
    for (std::uint64_t n = 0; n < columns * rows; ++n) {
        const Vec2 cell = {static_cast<double>(n % columns), static_cast<double>(n / columns)};
        const auto [dx, dy] = two_normals(key, jitter, n);
        const Vec2 at_mm =
            box.low + pitch_mm * (cell + Vec2{shift_x - 1.0 + 0.2 * dx, shift_y - 1.0 + 0.2 * dy});
        if (contains(region.outline_mm, at_mm))
            afferents.push_back({at_mm, kind, any_row(kind, two_uniforms(key, neuron, n)[0])});
    }
    return afferents;
}

std::vector<Afferent> populate(std::span<const HandRegion> regions,
                               std::span<const AfferentClass> kinds, std::uint64_t seed) {
    std::vector<Afferent> all;
    for (const HandRegion& region : regions)
        for (const AfferentClass kind : kinds)
            for (const Afferent& afferent : populate(region, kind, seed))
                all.push_back(afferent);
    return all;
}

std::vector<Afferent> grid_of_afferents(Vec2 center_mm, Vec2 extent_mm, double pitch_mm,
                                        std::span<const AfferentClass> kinds, std::uint64_t seed) {
    const auto half = [&](double length_mm) {
        return static_cast<std::ptrdiff_t>(std::floor(0.5 * length_mm / pitch_mm + 1e-9));
    };
    const std::ptrdiff_t half_x = half(extent_mm.x), half_y = half(extent_mm.y);
    std::vector<Afferent> all;
    for (const AfferentClass kind : kinds) {
        const std::uint64_t key = key_of("grid", kind, seed);
        std::uint64_t n = 0;
        for (std::ptrdiff_t i = -half_x; i <= half_x; ++i)
            for (std::ptrdiff_t j = -half_y; j <= half_y; ++j)
                all.push_back(
                    {center_mm + pitch_mm * Vec2{static_cast<double>(i), static_cast<double>(j)},
                     kind, any_row(kind, two_uniforms(key, neuron, n++)[0])});
    }
    return all;
}

} // namespace shearwake::neural
