// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/load/jump_tail.hpp"

#include "base/units.hpp"
#include "engines/layered/response/gauss_rule.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace shearwake::layered {
namespace {

using Complex = std::complex<double>;

constexpr int highest_power = 5; // of H
constexpr int highest_q = highest_power + static_cast<int>(jump_orders);
constexpr int per_unit = 32;
constexpr auto entries = static_cast<std::size_t>(tail_reach * per_unit) + 1;
/// Values at s = 0, 1/32, ...; q = 0 is the derivative of q = 1 without its delta function.
using RemovedParts = std::array<std::array<double, entries>, highest_q + 1>;

/// Calls visit(x, weight) at nodes that integrate e^{i x s} for |s| <= tail_reach.
template <class Visit>
void integrate(double from, double to, const Visit& visit) {
    const auto panels = static_cast<int>(std::ceil((to - from) * tail_reach / 20.0));
    const double half = 0.5 * (to - from) / panels;
    for (int panel = 0; panel < panels; ++panel)
        for (std::size_t i = 0; i < GaussRule::order; ++i)
            visit(from + half * (2 * panel + 1 + gauss_rule().node[i]),
                  half * gauss_rule().weight[i]);
}

RemovedParts make_removed_parts() {
    RemovedParts parts{};
    const Complex step_phase(0.0, 1.0 / per_unit);
    for (std::size_t n = 0; n < entries; ++n)
        parts[1][n] = 0.5;
    integrate(0.0, std::numbers::pi, [&](double x, double weight) {
        const double passed = weight * roll_off(x / std::numbers::pi) / std::numbers::pi;
        for (std::size_t n = 0; n < entries; ++n) {
            const double s = static_cast<double>(n) / per_unit;
            parts[0][n] -= passed * std::cos(x * s);
            parts[1][n] -= passed * std::sin(x * s) / x;
        }
    });
    // q = 2 is the integral of q = 1. Its value at s = 0 beyond x = pi has a closed form.
    const auto at_zero = [&](double x, double weight) {
        parts[2][0] -= weight * (1.0 - roll_off(x / std::numbers::pi)) / (std::numbers::pi * x * x);
    };
    integrate(0.8 * std::numbers::pi, std::numbers::pi, at_zero);
    parts[2][0] -= 1.0 / (std::numbers::pi * std::numbers::pi);
    for (std::size_t n = 1; n < entries; ++n)
        parts[2][n] = parts[2][n - 1] + (parts[1][n] + parts[1][n - 1]) / (2 * per_unit) +
                      (parts[0][n - 1] - parts[0][n]) / (12 * per_unit * per_unit);
    // Beyond 40 pi the integrand of q = 3 contributes 1e-3 of the whole at most.
    const auto of_higher = [&](double x, double weight) {
        const Complex turn = std::exp(x * step_phase);
        Complex value =
            weight * (1.0 - roll_off(x / std::numbers::pi)) / (std::numbers::pi * x * x);
        for (std::size_t n = 0; n < entries; ++n, value *= turn) {
            Complex part = -value; // (i x)^{-2}
            for (std::size_t q = 3; q <= highest_q; ++q) {
                part = Complex(part.imag(), -part.real()) / x;
                parts[q][n] += part.real();
            }
        }
    };
    integrate(0.8 * std::numbers::pi, std::numbers::pi, of_higher);
    integrate(std::numbers::pi, 40.0 * std::numbers::pi, of_higher);
    return parts;
}

} // namespace

double removed_part(int q, double s) {
    static const RemovedParts parts = make_removed_parts();
    const double distance = std::abs(s) * per_unit;
    if (distance >= static_cast<double>(entries - 1)) return 0.0;
    if (q == 1 && distance < 1e-6) return 0.0; // the mean of both sides
    const auto n = static_cast<std::size_t>(distance);
    const auto& f = parts[static_cast<std::size_t>(q)];
    const auto& slope = parts[static_cast<std::size_t>(q - 1)];
    // Cubic Hermite interpolation.
    const double t = distance - static_cast<double>(n), u = 1.0 - t;
    const double value = u * u * (1.0 + 2.0 * t) * f[n] + t * t * (1.0 + 2.0 * u) * f[n + 1] +
                         t * u * (u * slope[n] - t * slope[n + 1]) / per_unit;
    return s < 0.0 && q % 2 == 1 ? -value : value;
}

TailFit::TailFit(std::ptrdiff_t samples, StackQuantity quantity)
    : lowest_(quantity == StackQuantity::compression ? 0 : 1) {
    constexpr int fitted = 9;
    for (int i = 0; i < fitted; ++i) {
        const auto index = static_cast<std::ptrdiff_t>(
            std::llround((0.6 + 0.4 * i / (fitted - 1)) * 0.5 * static_cast<double>(samples)));
        if (index > 0 && index <= samples / 2 &&
            (frequencies_.empty() || index > frequencies_.back()))
            frequencies_.push_back(index);
    }
    const int powers = highest_power + 1 - lowest_;
    const auto rows = static_cast<Eigen::Index>(2 * frequencies_.size());
    Eigen::MatrixXd values(rows, powers);
    Eigen::VectorXd weights(rows);
    for (Eigen::Index row = 0; row < rows; ++row) {
        const double x = two_pi *
                         static_cast<double>(frequencies_[static_cast<std::size_t>(row / 2)]) /
                         static_cast<double>(samples);
        weights(row) = x * x; // H decays as its inverse
        for (int a = 0; a < powers; ++a) {
            const Complex power = std::pow(Complex(0.0, x), -(a + lowest_));
            values(row, a) = weights(row) * (row % 2 == 0 ? power.real() : power.imag());
        }
    }
    matrix_ = values.householderQr().solve(Eigen::MatrixXd(weights.asDiagonal()));
}

JumpTail::JumpTail(const TimeNodes& nodes, const TimeTransform& time, std::ptrdiff_t per_frame,
                   StackQuantity quantity) {
    const TailFit fit(time.samples, quantity);
    frequencies_ = fit.frequencies();
    const std::ptrdiff_t frames = time.samples / per_frame;
    const double interval = static_cast<double>(per_frame);
    const bool is_periodic = time.first_s > 0.0;
    for (std::size_t b = 0; b < nodes.breaks().size(); ++b) {
        const double at = (nodes.breaks()[b].time_s - time.first_s) / time.step_s; // in steps
        const auto last = static_cast<std::ptrdiff_t>(std::floor((at + tail_reach) / interval));
        auto first = static_cast<std::ptrdiff_t>(std::ceil((at - tail_reach) / interval));
        while (first <= last) {
            const std::ptrdiff_t turn = (first < 0 ? first - frames + 1 : first) / frames;
            const std::ptrdiff_t end = std::min(last + 1, (turn + 1) * frames);
            std::vector<double> distances;
            for (std::ptrdiff_t n = first; n < end; ++n)
                distances.push_back(static_cast<double>(n) * interval - at);
            if (is_periodic || turn == 0)
                add_near(fit, b, first - turn * frames, distances,
                         static_cast<double>(time.samples));
            first = end;
        }
    }
}

void JumpTail::add_near(const TailFit& fit, std::size_t of_break, std::ptrdiff_t first,
                        std::span<const double> distances, double samples) {
    const Eigen::Index count = std::ssize(distances), values = fit.matrix().cols();
    near_.push_back({of_break, first, count, weights_.size()});
    Eigen::MatrixXd removed(fit.matrix().rows(), count);
    for (int b = 0; b < jump_orders; ++b) {
        for (Eigen::Index a = 0; a < removed.rows(); ++a)
            for (Eigen::Index n = 0; n < count; ++n)
                removed(a, n) = removed_part(static_cast<int>(a) + fit.lowest_power() + b + 1,
                                             distances[static_cast<std::size_t>(n)]);
        const Eigen::MatrixXd weights = samples * fit.matrix().transpose() * removed;
        for (Eigen::Index v = 0; v < values; ++v)
            for (Eigen::Index n = 0; n < count; ++n)
                weights_.push_back(weights(v, n));
    }
}

void JumpTail::add(const ResponseKernels& kernels, std::span<const Complex> h, const Complex* jumps,
                   Complex* line) const {
    std::array<Complex, 16> fitted;
    for (std::size_t i = 0; i < frequencies_.size(); ++i)
        fitted[i] = h[static_cast<std::size_t>(frequencies_[i])];
    for (const Near& near : near_)
        kernels.add_tail(fft::reals(fitted.data()), 2 * std::ssize(frequencies_),
                         weights_.data() + near.at, near.count,
                         fft::reals(jumps + static_cast<std::size_t>(jump_orders) * near.of_break),
                         jump_orders, fft::reals(line + near.first));
}

} // namespace shearwake::layered
