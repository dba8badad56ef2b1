// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/motion/lissajous.hpp"

#include "base/units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake {
namespace {

/// Bisection ends when the sum of both halves agrees with the whole to this fraction of the largest
/// slope, or at this depth.
constexpr double agreement = 1e-15;
constexpr int most_halvings = 30;

struct GaussPoint {
    double x, weight;
};
// Gauss-Legendre with ten points on [-1, 1], symmetric (Abramowitz and Stegun, table 25.4).
constexpr GaussPoint gauss[] = {
    {0.148874338981631211, 0.295524224714752870}, {0.433395394129247191, 0.269266719309996355},
    {0.679409568299024406, 0.219086362515982044}, {0.865063366688984511, 0.149451349150580593},
    {0.973906528517171720, 0.066671344308688138},
};

} // namespace

Lissajous::Lissajous(const LissajousShape& shape) : shape_(shape), thetas_rad_{0.0}, arcs_m_{0.0} {
    // At turning points of x or y, the speed may vanish, and |speed| has a kink.
    std::vector<double> turns = {0.0, two_pi};
    const auto add_turns = [&](int n, double phase_rad) {
        for (int i = 0; i < 2 * n; ++i) {
            const double at = ((i + 0.5) * std::numbers::pi - phase_rad) / n;
            turns.push_back(at - two_pi * std::floor(at / two_pi));
        }
    };
    add_turns(shape.p, shape.phase_rad);
    add_turns(shape.q, 0.0);
    std::sort(turns.begin(), turns.end());
    for (std::size_t i = 1; i < turns.size(); ++i)
        if (turns[i] - turns[i - 1] > 1e-14)
            add_pieces(turns[i - 1], turns[i], piece_m(turns[i - 1], turns[i]), 0);
    thetas_rad_.back() = two_pi;
}

Vec2 Lissajous::slope(double theta) const {
    return {shape_.amplitudes_m.x * shape_.p * std::cos(shape_.p * theta + shape_.phase_rad),
            shape_.amplitudes_m.y * shape_.q * std::cos(shape_.q * theta)};
}

double Lissajous::piece_m(double from_rad, double to_rad) const {
    const double middle = 0.5 * (from_rad + to_rad), half = 0.5 * (to_rad - from_rad);
    double sum = 0.0;
    for (const auto& [x, weight] : gauss)
        sum += weight * (norm(slope(middle - half * x)) + norm(slope(middle + half * x)));
    return half * sum;
}

void Lissajous::add_pieces(double from_rad, double to_rad, double total_m, int depth) {
    const double middle = 0.5 * (from_rad + to_rad);
    const double first_m = piece_m(from_rad, middle), second_m = piece_m(middle, to_rad);
    const double largest_m =
        std::abs(shape_.amplitudes_m.x * shape_.p) + std::abs(shape_.amplitudes_m.y * shape_.q);
    if (depth < most_halvings &&
        std::abs(first_m + second_m - total_m) > agreement * largest_m * two_pi) {
        add_pieces(from_rad, middle, first_m, depth + 1);
        add_pieces(middle, to_rad, second_m, depth + 1);
        return;
    }
    thetas_rad_.insert(thetas_rad_.end(), {middle, to_rad});
    arcs_m_.push_back(arcs_m_.back() + first_m);
    arcs_m_.push_back(arcs_m_.back() + second_m);
}

double Lissajous::theta_rad(double arc_m) const {
    const auto above = std::upper_bound(arcs_m_.begin() + 1, arcs_m_.end() - 1, arc_m);
    const auto i = static_cast<std::size_t>(above - arcs_m_.begin());
    const double start = thetas_rad_[i - 1], wanted_m = arc_m - arcs_m_[i - 1];
    double low = start, high = thetas_rad_[i];
    double theta = start + (high - start) * wanted_m / (arcs_m_[i] - arcs_m_[i - 1]);
    for (int n = 0; n < 100; ++n) {
        const double off_m = piece_m(start, theta) - wanted_m;
        (off_m > 0.0 ? high : low) = theta;
        if (std::abs(off_m) <= 1e-16 * length_m()) break;
        const double speed = norm(slope(theta));
        double next = speed > 0.0 ? theta - off_m / speed : low;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (next == theta) break;
        theta = next;
    }
    return theta;
}

Vec2 Lissajous::at(double arc_m) const {
    const double theta = theta_rad(std::clamp(arc_m, 0.0, length_m()));
    const double beyond_m = arc_m - std::clamp(arc_m, 0.0, length_m());
    const Vec2 on_curve =
        shape_.center_m +
        Vec2{shape_.amplitudes_m.x * std::sin(shape_.p * theta + shape_.phase_rad),
             shape_.amplitudes_m.y * std::sin(shape_.q * theta)};
    return beyond_m == 0.0 ? on_curve : on_curve + beyond_m * tangent(arc_m);
}

Vec2 Lissajous::tangent(double arc_m) const {
    const double theta = theta_rad(std::clamp(arc_m, 0.0, length_m()));
    Vec2 along = slope(theta);
    // At a cusp, use the direction slightly later.
    if (!(norm(along) > 0.0)) along = slope(theta + 1e-6);
    return norm(along) > 0.0 ? (1.0 / norm(along)) * along : Vec2{1.0, 0.0};
}

} // namespace shearwake
