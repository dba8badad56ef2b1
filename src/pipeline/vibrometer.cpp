// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/vibrometer.hpp"

#include "base/units.hpp"
#include "sampling/design.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

namespace shearwake::pipeline {
namespace {

/// Streams of random numbers, apart from those of other users of a seed.
constexpr std::uint32_t noise_stream = 0x7669, missing_stream = 0x6d69;
constexpr std::ptrdiff_t stencil = 7; // frames
/// A filter in the periodic regime has settled after this number of its time constants.
constexpr double settling = 12.0;

/// One biquad of a Butterworth filter of second order, by the bilinear transform with the exact
/// cutoff.
class Butterworth {
public:
    enum class Kind { low_pass, high_pass };
    Butterworth(Kind kind, double cutoff_Hz, double rate_Hz) {
        const double w = std::tan(std::numbers::pi * cutoff_Hz / rate_Hz);
        const double norm = 1.0 / (1.0 + std::numbers::sqrt2 * w + w * w);
        const double gain = (kind == Kind::low_pass ? w * w : 1.0) * norm;
        b_ = {gain, kind == Kind::low_pass ? 2.0 * gain : -2.0 * gain, gain};
        a_ = {2.0 * (w * w - 1.0) * norm, (1.0 - std::numbers::sqrt2 * w + w * w) * norm};
    }
    void apply(std::span<double> values) const {
        double s1 = 0.0, s2 = 0.0; // transposed direct form II
        for (double& value : values) {
            const double out = b_[0] * value + s1;
            s1 = b_[1] * value - a_[0] * out + s2;
            s2 = b_[2] * value - a_[1] * out;
            value = out;
        }
    }

private:
    std::array<double, 3> b_;
    std::array<double, 2> a_;
};

/// Weights of the values at 0, 1, ..., count - 1 in the first two derivatives of their polynomial.
struct DerivativeWeights {
    std::vector<double> slope, curvature;
};

DerivativeWeights derivative_weights(std::ptrdiff_t count, double x) {
    DerivativeWeights weights;
    for (std::ptrdiff_t i = 0; i < count; ++i) {
        double slope = 0.0, curvature = 0.0;
        for (std::ptrdiff_t first = 0; first < count; ++first) {
            if (first == i) continue;
            double of_slope = 1.0 / static_cast<double>(i - first), of_curvature = 0.0;
            for (std::ptrdiff_t j = 0; j < count; ++j) {
                if (j == i || j == first) continue;
                const auto step = static_cast<double>(i - j), at = x - static_cast<double>(j);
                of_curvature = of_curvature * at / step + of_slope / step;
                of_slope *= at / step;
            }
            slope += of_slope;
            curvature += of_curvature;
        }
        weights.slope.push_back(slope);
        weights.curvature.push_back(curvature);
    }
    return weights;
}

/// The velocity of a point between the frames: the derivative of polynomials of degree 5 whose
/// values, slopes and curvatures at the frames are those of polynomials through seven frames. It is
/// continuous with its slope, so that a prediction depends smoothly on the trigger delay.
class Velocity {
public:
    explicit Velocity(const TimeAxis& time)
        : repeats_(time.regime == Regime::periodic), frames_(time.frames),
          interval_s_(time.interval_s),
          count_(repeats_ ? stencil : std::min(stencil, time.frames + 1)) {
        for (std::ptrdiff_t n = 0; n < count_; ++n)
            weights_.push_back(derivative_weights(count_, static_cast<double>(n)));
        nodes_.resize(static_cast<std::size_t>(frames_ + 1));
    }

    /// `u_m`: at the frames of a point.
    void set(std::span<const double> u_m) {
        for (std::ptrdiff_t n = 0; n <= frames_; ++n) {
            const std::ptrdiff_t first =
                repeats_ ? n - count_ / 2 : std::min(n - count_ / 2, frames_ + 1 - count_);
            const DerivativeWeights& weights = weights_[static_cast<std::size_t>(n - first)];
            Node& node = nodes_[static_cast<std::size_t>(n)];
            node = {displacement_m(u_m, n), 0.0, 0.0};
            for (std::ptrdiff_t i = 0; i < count_; ++i) {
                const double value = displacement_m(u_m, first + i);
                node.slope += weights.slope[static_cast<std::size_t>(i)] * value;
                node.curvature += weights.curvature[static_cast<std::size_t>(i)] * value;
            }
        }
    }

    double at_m_s(double t_s) const {
        if (!repeats_ && t_s < 0.0) return 0.0;
        const double at = t_s / interval_s_; // frame n is at n + 1
        auto before = static_cast<std::ptrdiff_t>(std::floor(at));
        if (!repeats_) before = std::clamp<std::ptrdiff_t>(before, 0, frames_ - 1);
        const double x = at - static_cast<double>(before);
        if (repeats_) before = ((before % frames_) + frames_) % frames_;
        const Node &a = nodes_[static_cast<std::size_t>(before)],
                   &b = nodes_[static_cast<std::size_t>(before) + 1];
        const double value = b.value - a.value - a.slope - 0.5 * a.curvature,
                     slope = b.slope - a.slope - a.curvature, curvature = b.curvature - a.curvature;
        const double third = 10.0 * value - 4.0 * slope + 0.5 * curvature,
                     fourth = -15.0 * value + 7.0 * slope - curvature,
                     fifth = 6.0 * value - 3.0 * slope + 0.5 * curvature;
        return (a.slope +
                x * (a.curvature + x * (3.0 * third + x * (4.0 * fourth + x * 5.0 * fifth)))) /
               interval_s_;
    }

private:
    /// In units of the interval.
    struct Node {
        double value = 0.0, slope = 0.0, curvature = 0.0;
    };
    /// At the time n times the interval. Before the start, the displacement is continued as an even
    /// function of time, so that the motion begins without velocity.
    double displacement_m(std::span<const double> u_m, std::ptrdiff_t n) const {
        std::ptrdiff_t frame = n - 1;
        if (repeats_)
            frame = ((frame % frames_) + frames_) % frames_;
        else if (n < 0)
            frame = -n - 1;
        return frame < 0 ? 0.0 : u_m[static_cast<std::size_t>(frame)];
    }

    bool repeats_;
    std::ptrdiff_t frames_;
    double interval_s_;
    std::ptrdiff_t count_;
    std::vector<DerivativeWeights> weights_; // by the position in the stencil
    std::vector<Node> nodes_;                // from t = 0 on
};

double normal(std::uint64_t seed, std::uint32_t stream, std::uint64_t counter) {
    const double u = sampling::random_uniform(seed, stream, 2 * counter),
                 v = sampling::random_uniform(seed, stream, 2 * counter + 1);
    return std::sqrt(-2.0 * std::log(u)) * std::cos(two_pi * v);
}

double power(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values)
        sum += value * value;
    return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

void filter(const Case& c, double rate_Hz, std::vector<double>& values) {
    const VibrometerOptions& o = *c.vibrometer;
    std::vector<Butterworth> filters;
    if (o.high_pass_Hz > 0.0)
        filters.emplace_back(Butterworth::Kind::high_pass, o.high_pass_Hz, rate_Hz);
    if (o.low_pass_Hz > 0.0)
        filters.emplace_back(Butterworth::Kind::low_pass, o.low_pass_Hz, rate_Hz);
    if (filters.empty()) return;
    const std::size_t length = values.size();
    if (c.time.regime == Regime::periodic) { // repeat the period until the filters have settled
        const double slowest_Hz = o.high_pass_Hz > 0.0 ? o.high_pass_Hz : o.low_pass_Hz;
        const double periods =
            std::ceil(settling * rate_Hz / (two_pi * slowest_Hz * static_cast<double>(length)));
        const auto copies = static_cast<std::size_t>(std::clamp(periods, 1.0, 10000.0));
        for (std::size_t n = 0; n < copies * length; ++n)
            values.push_back(values[n]);
    }
    for (const Butterworth& one : filters)
        one.apply(values);
    values.erase(values.begin(), values.end() - static_cast<std::ptrdiff_t>(length));
}

/// The points that return no signal.
std::vector<char> missing_points(const VibrometerOptions& o) {
    std::vector<char> is_missing(o.points_m.size(), 0);
    const auto count = static_cast<std::size_t>(
        std::lround(o.missing_share * static_cast<double>(o.points_m.size())));
    const auto order = sampling::random_permutation(
        o.points_m.size(), static_cast<std::uint64_t>(o.seed), missing_stream);
    for (std::size_t n = 0; n < count; ++n)
        is_missing[order[n]] = 1;
    return is_missing;
}

} // namespace

Scan scan(const Case& c, const std::vector<double>& displacements_m) {
    const VibrometerOptions& o = *c.vibrometer;
    const double rate_Hz = o.rate_Hz > 0.0 ? o.rate_Hz : 1.0 / c.time.interval_s;
    const bool repeats = c.time.regime == Regime::periodic;
    const double end_s = repeats ? c.time.duration_s() + o.trigger_delay_s : c.time.duration_s();
    // In the periodic regime, one period without its last time, which is the first one again.
    const double samples = std::floor((end_s - o.trigger_delay_s) * rate_Hz + 1e-9);
    Scan scan;
    for (double n = 0.0; n < samples + (repeats ? 0.0 : 1.0); ++n)
        scan.time_s.push_back(n / rate_Hz);
    const double noise_m_s =
        o.noise_m_s_rtHz * std::sqrt(0.5 * rate_Hz / static_cast<double>(o.averages));
    const std::vector<char> is_missing = missing_points(o);
    const auto frames = static_cast<std::size_t>(c.time.frames);
    Velocity velocity(c.time);
    for (std::size_t point = 0; point < o.points_m.size(); ++point) {
        velocity.set(std::span(displacements_m).subspan(point * frames, frames));
        std::vector<double> v(scan.time_s.size());
        for (std::size_t n = 0; n < v.size(); ++n)
            v[n] = velocity.at_m_s(scan.time_s[n] + o.trigger_delay_s);
        const double signal = power(v);
        for (std::size_t n = 0; n < v.size() && noise_m_s > 0.0; ++n)
            v[n] += noise_m_s * normal(static_cast<std::uint64_t>(o.seed), noise_stream,
                                       point * (std::uint64_t{1} << 32) + n);
        filter(c, rate_Hz, v);
        if (is_missing[point] != 0) std::fill(v.begin(), v.end(), not_a_number);
        const double all = signal + noise_m_s * noise_m_s;
        scan.quality.push_back(is_missing[point] != 0 || all == 0.0 ? 0.0 : signal / all);
        scan.velocity_m_s.insert(scan.velocity_m_s.end(), v.begin(), v.end());
    }
    return scan;
}

VariableGroup vibrometer_group(const Case& c, const std::vector<double>& displacements_m) {
    Scan recorded = scan(c, displacements_m);
    const VibrometerOptions& o = *c.vibrometer;
    std::vector<double> numbers(o.points_m.size()), x, y;
    std::iota(numbers.begin(), numbers.end(), 0.0);
    for (const Vec2 point : o.points_m) {
        x.push_back(point.x);
        y.push_back(point.y);
    }
    const Vec3 along = o.line_of_sight();
    VariableGroup group{"vibrometer", {}};
    group.add("point", {"point"}, numbers, "1", "number of the point of the scan");
    group.add("time", {"time"}, std::move(recorded.time_s), "s", "time since the trigger");
    group.add("x", {"point"}, x, "m", "position of the point along x");
    group.add("y", {"point"}, y, "m", "position of the point along y");
    group.add("velocity", {"point", "time"}, std::move(recorded.velocity_m_s), "m/s",
              "velocity along the line of sight, positive away from the vibrometer",
              "NaN: no signal");
    group.add("quality", {"point"}, std::move(recorded.quality), "1",
              "power of the signal divided by that of signal and noise; 0: no signal");
    group.add("trigger_delay", {}, {o.trigger_delay_s}, "s",
              "time from the start of the load to the trigger");
    group.add("direction_x", {}, {along.x}, "1", "line of sight, x component");
    group.add("direction_y", {}, {along.y}, "1", "line of sight, y component");
    group.add("direction_z", {}, {along.z}, "1", "line of sight, component into the skin");
    return group;
}

} // namespace shearwake::pipeline
