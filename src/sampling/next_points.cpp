// SPDX-License-Identifier: BSD-3-Clause
#include "sampling/next_points.hpp"

#include "base/units.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <optional>

namespace shearwake::adapt {
namespace {

using Goal = AdaptiveAxis::Goal;

/// New points with their priority, the largest first if not all of them fit.
using Proposals = std::map<double, double>;

/// Nine digits, as in tables.
double rounded(double value) {
    return std::stod(fmt::format("{:.9g}", value));
}

/// |f''| at each point by second divided differences of the points with values; NaN without.
std::vector<double> curvatures(const std::vector<double>& x, const Curve& y) {
    std::vector<double> found(x.size(), not_a_number);
    std::vector<std::size_t> known;
    for (std::size_t i = 0; i < x.size(); ++i)
        if (std::isfinite(y[i])) known.push_back(i);
    for (std::size_t k = 1; k + 1 < known.size(); ++k) {
        const std::size_t a = known[k - 1], b = known[k], c = known[k + 1];
        const double left = (y[b] - y[a]) / (x[b] - x[a]), right = (y[c] - y[b]) / (x[c] - x[b]);
        found[b] = 2.0 * std::abs(right - left) / (x[c] - x[a]);
    }
    return found;
}

/// The index of the best value of a curve; none if it has no values.
std::optional<std::size_t> best_of(const AdaptiveAxis& axis, const Curve& curve) {
    const double sign = axis.goal == Goal::minimum ? -1.0 : 1.0;
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < curve.size(); ++i)
        if (std::isfinite(curve[i]) && (!best || sign * curve[i] > sign * curve[*best])) best = i;
    return best;
}

bool crosses(const Curve& curve, std::size_t i) {
    return std::isfinite(curve[i]) && std::isfinite(curve[i + 1]) &&
           (curve[i] < 0.0) != (curve[i + 1] < 0.0);
}

/// Adds `parts - 1` points that divide interval i.
void divide(const std::vector<double>& x, std::size_t i, int parts, double priority,
            Proposals& added) {
    for (int part = 1; part < parts; ++part) {
        const double at = rounded(std::lerp(x[i], x[i + 1], static_cast<double>(part) / parts));
        if (at > x[i] && at < x[i + 1]) added[at] = std::max(added[at], priority);
    }
}

void refine(const AdaptiveAxis& axis, const std::vector<double>& x, const Curve& curve,
            Proposals& added) {
    const std::vector<double> errors = interpolation_errors(x, curve);
    // Half of an interval may not be shorter than the smallest step; the factor allows for
    // rounding.
    const double narrowest = 2.0 * axis.smallest_step * (1.0 - 1e-6);
    for (std::size_t i = 0; i < errors.size(); ++i)
        if (errors[i] > axis.tolerance && x[i + 1] - x[i] >= narrowest)
            divide(x, i, 2, errors[i], added);
}

void search(const AdaptiveAxis& axis, const std::vector<double>& x, const Curve& curve,
            Proposals& added) {
    const auto approach = [&](std::size_t i, int parts) {
        const double h = x[i + 1] - x[i];
        if (h > axis.tolerance) divide(x, i, parts, h, added);
    };
    if (axis.goal == Goal::crossing) {
        for (std::size_t i = 0; i + 1 < x.size(); ++i)
            if (crosses(curve, i)) approach(i, 4);
    } else if (const auto best = best_of(axis, curve)) {
        if (*best > 0) approach(*best - 1, 2);
        if (*best + 1 < x.size()) approach(*best, 2);
    }
}

} // namespace

std::vector<double> interpolation_errors(const std::vector<double>& x, const Curve& curve) {
    std::vector<double> errors(x.size() - 1, not_a_number);
    const std::vector<double> curved = curvatures(x, curve);
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
        const double h = x[i + 1] - x[i];
        for (std::size_t node = i == 0 ? 0 : i - 1; node <= std::min(i + 2, x.size() - 1); ++node)
            errors[i] = std::fmax(errors[i], h * h / 2.0 * curved[node]);
    }
    return errors;
}

std::vector<double> first_points(const AdaptiveAxis& axis) {
    std::vector<double> x;
    for (std::size_t i = 0; i < axis.initial; ++i)
        x.push_back(
            rounded(std::lerp(axis.first, axis.last,
                              static_cast<double>(i) / static_cast<double>(axis.initial - 1))));
    x.front() = axis.first;
    x.back() = axis.last;
    return x;
}

std::vector<double> next_points(const AdaptiveAxis& axis, const std::vector<double>& x,
                                const std::vector<Curve>& curves) {
    Proposals added;
    for (const Curve& curve : curves)
        axis.goal == Goal::refine ? refine(axis, x, curve, added) : search(axis, x, curve, added);
    std::vector<std::pair<double, double>> ranked(added.begin(), added.end());
    const std::size_t room = axis.most - std::min(axis.most, x.size());
    if (ranked.size() > room) {
        std::ranges::stable_sort(ranked, std::greater{}, &std::pair<double, double>::second);
        ranked.resize(room);
    }
    std::vector<double> next;
    for (const auto& proposal : ranked)
        next.push_back(proposal.first);
    std::ranges::sort(next);
    return next;
}

std::vector<Location> locations(const AdaptiveAxis& axis, const std::vector<double>& x,
                                const Curve& curve) {
    std::vector<Location> found;
    if (axis.goal == Goal::crossing) {
        for (std::size_t i = 0; i + 1 < x.size(); ++i)
            if (crosses(curve, i))
                found.push_back({std::lerp(x[i], x[i + 1], curve[i] / (curve[i] - curve[i + 1])),
                                 x[i], x[i + 1], 0.0});
    } else if (axis.is_extremum()) {
        if (const auto best = best_of(axis, curve))
            found.push_back({x[*best], x[*best == 0 ? 0 : *best - 1],
                             x[std::min(*best + 1, x.size() - 1)], curve[*best]});
    }
    return found;
}

} // namespace shearwake::adapt
