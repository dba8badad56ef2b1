// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_case.hpp"
#include "neural/hand/hand.hpp"
#include "problem/load/footprint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::config {
namespace {

/// Distance of the edges of the region "path" from the path.
constexpr double around_path_m = 30e-3;

std::vector<Vec2> rectangle(Vec2 low, Vec2 high) {
    return {low, {high.x, low.y}, high, {low.x, high.y}};
}

/// Points 20 um apart miss the extent of a curve of radius r by at most 5e-11 m^2 / r, and rounding
/// to 0.1 um removes this from a radius of 1 mm on, so that the region is as symmetric as the path.
std::vector<Vec2> around_path(const Load& load) {
    constexpr double step_m = 20e-6, digits_per_m = 1e7;
    // Most cases of a sweep have the path of the case before.
    static std::pair<Modulation, std::vector<Vec2>> last;
    if (!last.second.empty() && last.first == load.modulation) return last.second;
    Vec2 low, high;
    bool is_first = true;
    for (const auto& line : drawn_shape(load.modulation, step_m))
        for (const Vec2 point : line) {
            if (is_first) low = high = point;
            is_first = false;
            low = {std::min(low.x, point.x), std::min(low.y, point.y)};
            high = {std::max(high.x, point.x), std::max(high.y, point.y)};
        }
    const auto rounded = [](Vec2 at_m) {
        return Vec2{std::round(at_m.x * digits_per_m) / digits_per_m,
                    std::round(at_m.y * digits_per_m) / digits_per_m};
    };
    const Vec2 margin{around_path_m, around_path_m};
    last = {load.modulation, rectangle(rounded(low - margin), rounded(high + margin))};
    return last.second;
}

/// The outline in the coordinates of the domain.
std::vector<Vec2> palm(const std::optional<AfferentOptions>& afferents) {
    const neural::Patch patch = neural::patch_of(afferents.value_or(AfferentOptions{}));
    std::vector<Vec2> corners;
    for (const Vec2 corner_mm : neural::region(neural::make_hand(), "palm").outline_mm)
        corners.push_back(neural::on_patch_m(patch, corner_mm));
    return corners;
}

bool is_in_domain(const std::vector<Vec2>& corners, const Domain& domain) {
    const double slack_m = 1e-9;
    return std::ranges::all_of(corners, [&](Vec2 corner) {
        return std::abs(corner.x) <= 0.5 * domain.extent_x_m() - domain.sponge_m + slack_m &&
               std::abs(corner.y) <= 0.5 * domain.extent_y_m() - domain.sponge_m + slack_m;
    });
}

} // namespace

std::vector<Vec2> read_region(Reader& reader, const Measured& of) {
    const Domain& domain = of.domain;
    const NodePtr node = reader.node("region_mm");
    const bool is_word = node && std::holds_alternative<std::string>(node->value);
    if (reader.has("region_center_mm") && (!node || is_word))
        reader.error("region_center_mm", "applies only with a rectangle, region_mm = [x, y]");
    const Vec2 center_m = reader.point_or("region_center_mm", {});
    if (!node)
        return of.time.regime == Regime::periodic ? around_path(of.load) : std::vector<Vec2>{};
    if (is_word) {
        static const std::array<std::string, 2> words = {"path", "palm"};
        return reader.choice("region_mm", words) == "path" ? around_path(of.load)
                                                           : palm(of.afferents);
    }
    const Vec2 half_m = 0.5 * reader.point("region_mm", range_of<MeasureOptions>("region_mm"));
    std::vector<Vec2> corners = rectangle(center_m - half_m, center_m + half_m);
    if (domain.nx > 0 && !is_in_domain(corners, domain))
        reader.error("region_mm",
                     fmt::format("must lie inside the domain without its sponge, within {:.6g} and "
                                 "{:.6g} mm of its centre; the rectangle reaches from [{:.6g}, "
                                 "{:.6g}] to [{:.6g}, {:.6g}] mm",
                                 500.0 * domain.extent_x_m() - 1e3 * domain.sponge_m,
                                 500.0 * domain.extent_y_m() - 1e3 * domain.sponge_m,
                                 1e3 * corners[0].x, 1e3 * corners[0].y, 1e3 * corners[2].x,
                                 1e3 * corners[2].y));
    return corners;
}

} // namespace shearwake::config
