// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/load/time_nodes.hpp"

#include "engines/layered/response/gauss_rule.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace shearwake::layered {
namespace {

/// The width in steps of the erfc edges of the window around a break: the samples' weight is 6e-6
/// at the break and 1 - 6e-6 at the ends of the window.
constexpr double window = break_window_steps, edge = 1.6;
/// Distances in steps from a break at which the load is evaluated for its jumps.
constexpr double nearest = 2e-5, apart = 1.0 / 64.0;

/// Chebyshev coefficients in `share` of the coefficients of interpolation().
constexpr int degrees = 16;
using Expansion = Eigen::Matrix<double, degrees, taps>;

Expansion fit_interpolation() {
    constexpr int frequencies = 200;
    // The weight is constant below this frequency, where the response to a jump is large anyway.
    constexpr double flat_below = 0.3;
    Eigen::MatrixXd matrix(2 * frequencies, taps), rhs(2 * frequencies, degrees);
    for (int f = 0; f < frequencies; ++f) {
        const double x = std::numbers::pi * (f + 0.5) / frequencies;
        const double weight =
            roll_off(x / std::numbers::pi) * std::pow(flat_below * flat_below + x * x, -1.5);
        for (int l = 0; l < taps; ++l) {
            const double at = l - taps / 2 + 1;
            matrix(f, l) = weight * std::cos(x * at);
            matrix(frequencies + f, l) = weight * std::sin(x * at);
        }
        for (int d = 0; d < degrees; ++d) {
            const double share = 0.5 + 0.5 * std::cos(std::numbers::pi * (d + 0.5) / degrees);
            rhs(f, d) = weight * std::cos(x * share);
            rhs(frequencies + f, d) = weight * std::sin(x * share);
        }
    }
    const Eigen::MatrixXd at_nodes = matrix.householderQr().solve(rhs); // taps x degrees
    Expansion expansion = Expansion::Zero();
    for (int n = 0; n < degrees; ++n)
        for (int d = 0; d < degrees; ++d)
            expansion.row(n) += (n == 0 ? 1.0 : 2.0) / degrees *
                                std::cos(std::numbers::pi * n * (d + 0.5) / degrees) *
                                at_nodes.col(d).transpose();
    return expansion;
}

} // namespace

double roll_off(double of_highest) {
    const double x = std::clamp((of_highest - 0.8) / 0.2, 0.0, 1.0);
    return std::pow(std::cos(0.5 * std::numbers::pi * x), 2);
}

std::vector<double> roll_off(const TimeTransform& time) {
    std::vector<double> factors(static_cast<std::size_t>(time.samples));
    for (std::ptrdiff_t m = 0; m < time.samples; ++m)
        factors[static_cast<std::size_t>(m)] =
            roll_off(2.0 * static_cast<double>(std::min(m, time.samples - m)) /
                     static_cast<double>(time.samples));
    return factors;
}

std::array<double, taps> interpolation(double share) {
    static const Expansion expansion = fit_interpolation();
    const double x = 2.0 * share - 1.0;
    Eigen::Matrix<double, 1, degrees> polynomials;
    polynomials(0) = 1.0;
    polynomials(1) = x;
    for (int n = 2; n < degrees; ++n)
        polynomials(n) = 2.0 * x * polynomials(n - 1) - polynomials(n - 2);
    std::array<double, taps> coefficients{};
    Eigen::Map<Eigen::Matrix<double, 1, taps>>(coefficients.data()) = polynomials * expansion;
    return coefficients;
}

TimeNodes::TimeNodes(const Case& c, const TimeTransform& time)
    : time_(time), samples_(time.samples), duration_s_(c.time.duration_s()) {
    const double h = time.step_s, period_s = static_cast<double>(samples_) * h;
    const bool is_periodic = c.time.regime == Regime::periodic;
    if (is_periodic) duration_s_ = std::numeric_limits<double>::infinity();
    const Load& load = c.scene.load;
    const double end_s = std::min(time.first_s + period_s, duration_s_ + 1.6 * window * h);
    breaks_ = breaks_of(load, time.first_s, end_s, h);

    for (std::ptrdiff_t i = 0; i < samples_; ++i) {
        times_s_.push_back(time.sample_s(i));
        weights_.push_back(taper(times_s_.back()) * smooth_share(times_s_.back()));
    }
    for (std::size_t b = 0; b < breaks_.size(); ++b) {
        const double at_s = breaks_[b].time_s, reach_s = window * h;
        const bool is_last = b + 1 == breaks_.size();
        const double next_s = !is_last      ? breaks_[b + 1].time_s
                              : is_periodic ? breaks_.front().time_s + period_s
                                            : std::numeric_limits<double>::infinity();
        if (b == 0 && !is_periodic) add_nodes(c, at_s - reach_s, at_s);
        if (next_s - at_s <= 2.0 * reach_s) {
            add_nodes(c, at_s, next_s);
            continue;
        }
        add_nodes(c, at_s, at_s + reach_s);
        if (next_s < std::numeric_limits<double>::infinity())
            add_nodes(c, next_s - reach_s, next_s);
    }
    for (const Break& each : breaks_)
        for (const double side : {-1.0, 1.0})
            for (std::ptrdiff_t i = 0; i < jump_orders; ++i) {
                times_s_.push_back(each.time_s +
                                   side * h * (nearest + static_cast<double>(i) * apart));
                weights_.push_back(1.0);
            }
}

/// In the periodic regime, the same instant of the first period: an array has no later ones.
double TimeNodes::within_period_s(double t_s) const {
    if (!std::isinf(duration_s_)) return t_s;
    const double period_s = static_cast<double>(samples_) * time_.step_s;
    return t_s - period_s * std::floor((t_s - time_.first_s) / period_s);
}

double TimeNodes::taper(double t_s) const {
    if (t_s <= duration_s_) return 1.0;
    const double period_s = static_cast<double>(samples_) * time_.step_s;
    const double x = std::min(1.0, (t_s - duration_s_) / (0.5 * (period_s - duration_s_)));
    return std::pow(std::cos(0.5 * std::numbers::pi * x), 2);
}

/// The share of the load that the samples represent. In the periodic regime the breaks repeat:
/// those of all periods count, so that the share is smooth also if a period has few samples.
double TimeNodes::smooth_share(double t_s) const {
    const double period_s = std::isinf(duration_s_) ? static_cast<double>(samples_) * time_.step_s
                                                    : std::numeric_limits<double>::infinity();
    double share = 1.0;
    const auto pass_break = [&](double distance_s) {
        const double steps = distance_s / time_.step_s;
        if (steps < window) share *= 1.0 - 0.5 * std::erfc((steps - 0.5 * window) / edge);
        return steps < window;
    };
    for (const Break& each : breaks_) {
        const double distance_s = std::fmod(std::abs(t_s - each.time_s), period_s);
        for (double away_s = distance_s; pass_break(away_s); away_s += period_s)
            ;
        for (double away_s = period_s - distance_s; pass_break(away_s); away_s += period_s)
            ;
    }
    return share;
}

/// Nodes of a part on which the load is smooth. Those at which it is zero are left out.
void TimeNodes::add_nodes(const Case& c, double from_s, double to_s) {
    const double h = time_.step_s;
    const double half_s = 0.5 * (to_s - from_s);
    // At most 3.5 rad per step, of which a Gauss rule of n nodes integrates 2 n - 10 to 1e-6.
    const auto count = static_cast<int>(std::ceil(3.8 * half_s / h)) + 5;
    for (const auto& [node, weight] : gauss_nodes(count)) {
        const double t_s = within_period_s(from_s + half_s * (1.0 + node));
        const double share = taper(t_s) * (1.0 - smooth_share(t_s));
        if (share == 0.0 || strength(c.scene.load, t_s) == 0.0) continue;
        const double steps = (t_s - time_.first_s) / h, before = std::floor(steps);
        const std::ptrdiff_t first =
            (static_cast<std::ptrdiff_t>(before) - taps / 2 + 1) % samples_;
        times_s_.push_back(t_s);
        weights_.push_back(weight * half_s / h * share);
        first_.push_back(first < 0 ? first + samples_ : first);
        for (const double coefficient : interpolation(steps - before)) {
            coefficients_.push_back(coefficient);
            coefficients_.push_back(coefficient);
        }
    }
}

std::array<std::complex<double>, jump_orders> jumps(const std::complex<double>* values) {
    std::array<std::complex<double>, jump_orders> sum{};
    for (const double side : {-1.0, 1.0}) {
        const std::complex<double>* v = values + (side > 0.0 ? jump_orders : 0);
        const auto first = v[1] - v[0], second = v[2] - 2.0 * v[1] + v[0],
                   third = v[3] - 3.0 * (v[2] - v[1]) - v[0];
        const double rate = side / apart; // divided differences have the sign of their step
        sum[0] += side * v[0];
        sum[1] += side * rate * (first - 0.5 * second + third / 3.0);
        sum[2] += side * rate * rate * (second - third);
        sum[3] += side * rate * rate * rate * third;
    }
    return sum;
}

} // namespace shearwake::layered
