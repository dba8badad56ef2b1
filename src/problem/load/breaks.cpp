// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/breaks.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace shearwake {
namespace {

constexpr double least_jump = 1e-4;
/// Changes that are closer than this part of a cell are one break: different parts of the load
/// change at one instant, which is computed in different ways.
constexpr double one_instant = 1e-5;

/// Numbers that do not change while the load is smooth.
std::vector<double> smooth_pieces(const Load& load, double t_s) {
    std::vector<double> numbers = {t_s < 0.0 ? 0.0 : 1.0};
    const Modulation& modulation = load.modulation;
    numbers.push_back(t_s > off_time_s(modulation.trajectory) ? 1.0 : 0.0);
    add_smooth_pieces(modulation.envelope, t_s, numbers);
    const double held = held_s(load, t_s);
    if (held == t_s)
        add_smooth_pieces(modulation.trajectory, t_s, numbers);
    else
        numbers.push_back(held);
    return numbers;
}

/// The load and its first two derivatives on one side of a time, each multiplied by `cell_s`.
struct Limit {
    std::array<Vec2, 3> position_m;
    std::array<double, 3> strength{};
};

template <class Value>
std::array<Value, 3> derivatives(const std::array<Value, 3>& values, double step) {
    return {values[0], (0.5 / step) * (4.0 * values[1] - 3.0 * values[0] - values[2]),
            (1.0 / (step * step)) * (values[0] - 2.0 * values[1] + values[2])};
}

/// By differences over 1/32 of a cell, from `nearest` cells on.
Limit limit(const Load& load, double t_s, double cell_s, double side) {
    constexpr double nearest = 2.0 * one_instant, step = 1.0 / 64.0;
    std::array<Vec2, 3> positions_m;
    std::array<double, 3> strengths{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double at_s = t_s + side * cell_s * (nearest + static_cast<double>(i) * step);
        positions_m[i] = focus_m(load, at_s);
        strengths[i] = strength(load, at_s);
    }
    return {derivatives(positions_m, side * step), derivatives(strengths, side * step)};
}

/// Changes of the load, its slope and its curvature.
std::array<double, 3> changes(const Limit& before, const Limit& after, double width_m) {
    std::array<double, 3> sizes{};
    const double most = std::max(before.strength[0], after.strength[0]);
    for (std::size_t i = 0; i < 3; ++i)
        sizes[i] = std::max(std::abs(after.strength[i] - before.strength[i]),
                            most * norm(after.position_m[i] - before.position_m[i]) / width_m);
    return sizes;
}

/// Ascending times in (from_s, to_s) at which the pieces change.
std::vector<double> changes_of_pieces_s(const Load& load, double from_s, double to_s,
                                        double cell_s) {
    std::vector<double> times_s;
    const auto count = static_cast<std::ptrdiff_t>(std::ceil(4.0 * (to_s - from_s) / cell_s));
    double before_s = from_s;
    std::vector<double> before = smooth_pieces(load, before_s);
    for (std::ptrdiff_t n = 1; n <= count; ++n) {
        const double next_s =
            from_s + (to_s - from_s) * static_cast<double>(n) / static_cast<double>(count);
        const std::vector<double> next = smooth_pieces(load, next_s);
        while (before != next) {
            double low_s = before_s, high_s = next_s;
            for (double middle_s = 0.5 * (low_s + high_s); low_s < middle_s && middle_s < high_s;
                 middle_s = 0.5 * (low_s + high_s))
                (smooth_pieces(load, middle_s) == before ? low_s : high_s) = middle_s;
            if (times_s.empty() || high_s - times_s.back() > one_instant * cell_s)
                times_s.push_back(high_s);
            before_s = high_s;
            before = smooth_pieces(load, before_s);
        }
        before_s = next_s;
    }
    return times_s;
}

} // namespace

Vec2 focus_m(const Load& load, double t_s) {
    return position(load.modulation.trajectory, held_s(load, t_s));
}

std::vector<Break> breaks_of(const Load& load, double from_s, double to_s, double cell_s) {
    const double width_m = fwhm_m(load.footprint) / (2.0 * std::sqrt(2.0 * std::log(2.0)));
    std::vector<Break> all;
    // A break at from_s is a change after an earlier instant.
    const double earlier_s = one_instant * cell_s;
    for (const double time_s :
         changes_of_pieces_s(load, from_s - earlier_s, to_s - earlier_s, cell_s)) {
        const Limit before = limit(load, time_s, cell_s, -1.0),
                    after = limit(load, time_s, cell_s, 1.0);
        const auto [jump, kink, bend] = changes(before, after, width_m);
        if (jump >= least_jump || kink >= 1e-3 || bend >= 3e-3)
            all.push_back(
                {.time_s = time_s, .jump = std::min(jump, 1.0), .kink = kink, .bend = bend});
    }
    std::vector<Break> kept;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const bool is_close =
            (i > 0 && all[i].time_s - all[i - 1].time_s < 0.99 * cell_s) ||
            (i + 1 < all.size() && all[i + 1].time_s - all[i].time_s < 0.99 * cell_s);
        if (all[i].jump >= least_jump || !is_close) kept.push_back(all[i]);
    }
    return kept;
}

} // namespace shearwake
