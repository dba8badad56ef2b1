// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/load.hpp"

#include "base/units.hpp"
#include "problem/load/load_pattern.hpp"
#include "problem/load/modulation.hpp"
#include "problem/load/motion/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <numeric>

namespace shearwake {
namespace {

/// Chebyshev nodes from `low_m` to `high_m`; one node if both are equal. The force of an array
/// varies smoothly over an eighth of its distance from the skin, so that the polynomial through the
/// nodes is accurate to 1e-5, and to 1e-7 for a single focus.
class Nodes {
public:
    Nodes(double low_m, double high_m, double distance_m) {
        constexpr double fewest = 5.0, per_distance = 16.0;
        const int last =
            high_m > low_m ? static_cast<int>(fewest + per_distance * (high_m - low_m) / distance_m)
                           : 0;
        for (int n = 0; n <= last; ++n)
            at_m_.push_back(last == 0 ? low_m
                                      : 0.5 * (low_m + high_m) -
                                            0.5 * (high_m - low_m) *
                                                std::cos(std::numbers::pi * n / last));
    }
    const std::vector<double>& at_m() const { return at_m_; }
    /// The factors of the values at the nodes in the polynomial through them, by the barycentric
    /// formula.
    std::vector<double> factors(double x_m) const {
        std::vector<double> factors;
        double sum = 0.0;
        for (std::size_t n = 0; n < at_m_.size(); ++n) {
            const double distance_m = x_m - at_m_[n];
            if (distance_m == 0.0) {
                factors.assign(at_m_.size(), 0.0);
                factors[n] = 1.0;
                return factors;
            }
            const bool is_end = n == 0 || n + 1 == at_m_.size();
            factors.push_back((n % 2 ? -1.0 : 1.0) * (is_end ? 0.5 : 1.0) / distance_m);
            sum += factors.back();
        }
        for (double& factor : factors)
            factor /= sum;
        return factors;
    }

private:
    std::vector<double> at_m_;
};

/// A smooth function of the position at all of these positions.
template <class F>
std::vector<double> smooth_values(const std::vector<Vec2>& at_m, double distance_m, F f) {
    Vec2 low = at_m.front(), high = low;
    for (const Vec2& at : at_m) {
        low = {std::min(low.x, at.x), std::min(low.y, at.y)};
        high = {std::max(high.x, at.x), std::max(high.y, at.y)};
    }
    const Nodes x(low.x, high.x, distance_m), y(low.y, high.y, distance_m);
    std::vector<double> values;
    if (x.at_m().size() * y.at_m().size() >= at_m.size()) {
        for (const Vec2& at : at_m)
            values.push_back(f(at));
        return values;
    }
    std::vector<double> nodes;
    for (const double node_x : x.at_m())
        for (const double node_y : y.at_m())
            nodes.push_back(f({node_x, node_y}));
    for (const Vec2& at : at_m) {
        const std::vector<double> along_x = x.factors(at.x), along_y = y.factors(at.y);
        double sum = 0.0;
        for (std::size_t i = 0; i < along_x.size(); ++i)
            sum += along_x[i] * std::inner_product(along_y.begin(), along_y.end(),
                                                   nodes.data() + i * along_y.size(), 0.0);
        values.push_back(sum);
    }
    return values;
}

/// A function of the position that is not smooth, at `most` positions and constant between. They
/// are irregular, so that a path that repeats is sampled at others each time.
template <class F>
std::vector<double> rough_values(const std::vector<Vec2>& at_m, std::size_t most, F f) {
    const std::size_t stride = at_m.size() / most + (at_m.size() % most > 0);
    std::vector<double> values;
    for (std::size_t n = 0; n < at_m.size(); ++n) {
        const double share = std::fmod(static_cast<double>(n / stride) / std::numbers::phi, 1.0);
        const auto within = static_cast<std::size_t>(share * static_cast<double>(stride));
        values.push_back(n % stride == 0 ? f(at_m[std::min(n + within, at_m.size() - 1)])
                                         : values.back());
    }
    return values;
}

/// Rounded phases jump as the focus moves, and so does the result of an iteration.
bool is_smooth(const ArrayFootprint& array, std::size_t foci) {
    return array.phase_levels == 0 && (array.hologram == Hologram::superposition || foci < 2);
}

} // namespace

double amplitude(const Load& load, double t_s) {
    const double c = std::visit(overloaded{
                                    [](const AveragedCarrier&) { return 1.0; },
                                    [&](const ResolvedCarrier& carrier) {
                                        return 1.0 + std::cos(two_pi * carrier.frequency_Hz * t_s);
                                    },
                                },
                                load.carrier);
    return gain(load.modulation.envelope, t_s) * level(load.modulation.trajectory, t_s) * c;
}

double strength(const Load& load, double t_s) {
    if (t_s < 0.0 || t_s > off_time_s(load.modulation.trajectory)) return 0.0;
    return amplitude(load, t_s);
}

double updated_s(const Load& load, double t_s) {
    const double rate_Hz = update_rate_Hz(load.footprint);
    // A sample at the time of an update uses the new focus.
    return rate_Hz == 0.0 ? t_s : std::floor(t_s * rate_Hz + 1e-9) / rate_Hz;
}

std::vector<double> force_areas_m2(const Load& load, std::span<const double> times_s,
                                   std::size_t most_rough) {
    if (times_s.empty()) return {};
    LoadPattern pattern(load, times_s.back());
    const auto area_at = [&](Vec2 focus_m) {
        const double k_zero = 0.0;
        std::complex<double> area;
        pattern.set_focus(focus_m);
        pattern.spectra(0.0, {&k_zero, 1}, {&area, 1});
        return area.real();
    };
    std::vector<Vec2> foci_m;
    for (const double t_s : times_s)
        foci_m.push_back(position(load.modulation.trajectory, pattern.updated_s(t_s)));
    if (!pattern.changes()) return std::vector<double>(times_s.size(), area_at(foci_m.front()));
    const auto& array = std::get<ArrayFootprint>(load.footprint);
    return is_smooth(array, load.modulation.foci_m.size())
               ? smooth_values(foci_m, array.distance_m, area_at)
               : rough_values(foci_m, most_rough, area_at);
}

std::vector<double> forces_N(const Load& load, std::span<const double> times_s) {
    std::vector<double> forces = force_areas_m2(load, times_s);
    for (std::size_t n = 0; n < forces.size(); ++n)
        forces[n] *= load.peak_Pa * strength(load, times_s[n]);
    return forces;
}

namespace {

/// Deviation from a whole number of periods, in periods.
constexpr double commensurate = 1e-6;
/// Largest number of periods of the lowest frequency that are tried as a common period.
constexpr double most_periods = 1e6;

void add_of(const Mover& mover, std::vector<double>& frequencies_Hz) {
    std::visit(overloaded{[](const Hold&) {},
                          [&](const Swing& swing) {
                              if (norm(swing.amplitude_m) > 0.0)
                                  frequencies_Hz.push_back(swing.frequency_Hz);
                          },
                          [&](const Travel& travel) {
                              const auto* speed = std::get_if<OscillatingSpeed>(&travel.motion);
                              if (!speed) {
                                  frequencies_Hz.push_back(1.0 / cycle_s(travel));
                                  return;
                              }
                              frequencies_Hz.push_back(speed->mean_m_s / cycle_m(travel));
                              if (speed->deviation_m_s != 0.0)
                                  frequencies_Hz.push_back(speed->frequency_Hz);
                          }},
               mover);
}

std::string listed(const std::vector<double>& frequencies_Hz) {
    std::string text;
    for (std::size_t i = 0; i < frequencies_Hz.size(); ++i)
        text += fmt::format("{}{:.8g}",
                            i == 0                           ? ""
                            : i + 1 == frequencies_Hz.size() ? " and "
                                                             : ", ",
                            frequencies_Hz[i]);
    return text;
}

/// The frequency nearest to one of a pair that has a common period with the other: that of the
/// shortest period up to `longest_s` for which it changes by at most 1 %, or else the nearest one.
struct Commensurate {
    double frequency_Hz = 0.0, period_s = 0.0; // 0: there is none
};
Commensurate commensurate_with(double other_Hz, double frequency_Hz, double longest_s) {
    constexpr double small = 0.01;
    Commensurate nearest;
    const double most = std::min(longest_s * (1.0 + 1e-9) * other_Hz, most_periods);
    for (double periods = 1.0; periods <= most; ++periods) {
        const double period_s = periods / other_Hz,
                     found_Hz = std::max(1.0, std::round(frequency_Hz * period_s)) / period_s;
        if (nearest.period_s == 0.0 ||
            std::abs(found_Hz - frequency_Hz) < std::abs(nearest.frequency_Hz - frequency_Hz))
            nearest = {found_Hz, period_s};
        if (std::abs(nearest.frequency_Hz - frequency_Hz) <= small * frequency_Hz) break;
    }
    return nearest;
}

/// The constant or mean speed of the path that repeats with this frequency; 0 if there is none.
double speed_of_cycle_m_s(const Load& load, double frequency_Hz) {
    for (const Mover& mover : load.modulation.trajectory.parts)
        if (const auto* travel = std::get_if<Travel>(&mover)) {
            const double speed_m_s = frequency_Hz * cycle_m(*travel);
            const auto is_speed = [&](double given_m_s) {
                return std::abs(speed_m_s - given_m_s) <= commensurate * given_m_s;
            };
            if (const auto* constant = std::get_if<ConstantSpeed>(&travel->motion);
                constant && is_speed(constant->speed_m_s))
                return speed_m_s;
            if (const auto* oscillates = std::get_if<OscillatingSpeed>(&travel->motion);
                oscillates && is_speed(oscillates->mean_m_s))
                return speed_m_s;
        }
    return 0.0;
}

/// ", for example ...": what gives two frequencies a common period; empty for more of them.
std::string usable_values(const Load& load, const std::vector<double>& frequencies_Hz,
                          double longest_s) {
    if (frequencies_Hz.size() != 2) return {};
    std::string text;
    for (const std::size_t i : {0u, 1u}) {
        const double given_Hz = frequencies_Hz[i];
        const Commensurate usable = commensurate_with(frequencies_Hz[1 - i], given_Hz, longest_s);
        if (usable.period_s == 0.0) continue;
        const double speed_m_s = speed_of_cycle_m_s(load, given_Hz);
        const double unit = speed_m_s > 0.0 ? speed_m_s / given_Hz : 1.0;
        text += fmt::format("{}{:.10g} {} instead of {:.8g} (period {:.4g} ms)",
                            text.empty() ? ", for example " : " or ", unit * usable.frequency_Hz,
                            speed_m_s > 0.0 ? "m/s" : "Hz", unit * given_Hz, 1e3 * usable.period_s);
    }
    return text;
}

} // namespace

std::string aperiodicity_reason(const Load& load) {
    for (const Mover& mover : load.modulation.trajectory.parts)
        if (const auto* travel = std::get_if<Travel>(&mover))
            if (travel->at_end == AtEnd::off || travel->at_end == AtEnd::hold)
                return "has a path that ends; set path.at_end = \"repeat\" or \"back-and-forth\"";
    if (std::ranges::any_of(load.modulation.envelope.gains, acts_once))
        return "rises or falls once (a ramp, a window, or samples that are not repeated), which a "
               "load that repeats for ever cannot; remove it, or set repeat = true";
    return {};
}

std::vector<double> frequencies_of(const Load& load) {
    std::vector<double> frequencies_Hz;
    for (const Mover& mover : load.modulation.trajectory.parts)
        add_of(mover, frequencies_Hz);
    if (const double rate_Hz = update_rate_Hz(load.footprint);
        rate_Hz > 0.0 && !frequencies_Hz.empty())
        frequencies_Hz.push_back(rate_Hz);
    for (const Gain& gain : load.modulation.envelope.gains)
        if (const double gain_Hz = repetition_Hz(gain); gain_Hz > 0.0)
            frequencies_Hz.push_back(gain_Hz);
    if (const double carrier_Hz = carrier_frequency_Hz(load.carrier); carrier_Hz > 0.0)
        frequencies_Hz.push_back(carrier_Hz);
    std::ranges::sort(frequencies_Hz);
    const auto same = std::unique(frequencies_Hz.begin(), frequencies_Hz.end());
    frequencies_Hz.erase(same, frequencies_Hz.end());
    return frequencies_Hz;
}

LoadPeriod least_period(const Load& load, double longest_s) {
    if (std::string reason = aperiodicity_reason(load); !reason.empty())
        return {0.0, std::move(reason)};
    const std::vector<double> frequencies_Hz = frequencies_of(load);
    if (frequencies_Hz.empty())
        return {0.0, "is constant and therefore has no period; use time.regime = \"transient\""};
    const double most = longest_s * (1.0 + 1e-9) * frequencies_Hz.front();
    for (double periods = 1.0; periods <= std::min(most, most_periods); ++periods) {
        const double period_s = periods / frequencies_Hz.front();
        if (std::ranges::all_of(frequencies_Hz, [&](double frequency_Hz) {
                const double count = frequency_Hz * period_s;
                return std::abs(count - std::round(count)) <= commensurate;
            }))
            return {period_s, ""};
    }
    if (most > most_periods)
        return {0.0, fmt::format("has the lowest frequency {:.8g} Hz and no common period of up to "
                                 "{:.0f} of its periods, the largest number that is supported; use "
                                 "commensurate or lower frequencies",
                                 frequencies_Hz.front(), most_periods)};
    return {0.0, fmt::format("has the {} {} Hz, which have no common period of up to {:g} ms; use "
                             "commensurate frequencies{}, or increase time.longest_period_ms",
                             frequencies_Hz.size() > 1 ? "frequencies" : "frequency",
                             listed(frequencies_Hz), 1e3 * longest_s,
                             usable_values(load, frequencies_Hz, longest_s))};
}

namespace {

constexpr double least_jump = 1e-4;
/// Changes that are closer than this part of a cell are one break: different parts of the load
/// change at one instant, which is computed in different ways.
constexpr double one_instant = 1e-5;

/// Assigns numbers that do not change while the load is smooth. `off_s`: off_time_s() of the
/// trajectory.
void assign_smooth_pieces(const Load& load, double t_s, double off_s,
                          std::vector<double>& numbers) {
    numbers.assign(1, t_s < 0.0 ? 0.0 : 1.0);
    const Modulation& modulation = load.modulation;
    numbers.push_back(t_s > off_s ? 1.0 : 0.0);
    add_smooth_pieces(modulation.envelope, t_s, numbers);
    const double updated = updated_s(load, t_s);
    if (updated == t_s)
        add_smooth_pieces(modulation.trajectory, t_s, numbers);
    else
        numbers.push_back(updated);
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
    const double off_s = off_time_s(load.modulation.trajectory);
    std::vector<double> before, next, middle; // the pieces; reused, since there are many times
    assign_smooth_pieces(load, before_s, off_s, before);
    for (std::ptrdiff_t n = 1; n <= count; ++n) {
        const double next_s =
            from_s + (to_s - from_s) * static_cast<double>(n) / static_cast<double>(count);
        assign_smooth_pieces(load, next_s, off_s, next);
        while (before != next) {
            double low_s = before_s, high_s = next_s;
            for (double middle_s = 0.5 * (low_s + high_s); low_s < middle_s && middle_s < high_s;
                 middle_s = 0.5 * (low_s + high_s)) {
                assign_smooth_pieces(load, middle_s, off_s, middle);
                (middle == before ? low_s : high_s) = middle_s;
            }
            if (times_s.empty() || high_s - times_s.back() > one_instant * cell_s)
                times_s.push_back(high_s);
            before_s = high_s;
            assign_smooth_pieces(load, before_s, off_s, before);
        }
        before_s = next_s;
    }
    return times_s;
}

} // namespace

Vec2 focus_m(const Load& load, double t_s) {
    return position(load.modulation.trajectory, updated_s(load, t_s));
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
    std::vector<Break> relevant;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const bool is_close =
            (i > 0 && all[i].time_s - all[i - 1].time_s < 0.99 * cell_s) ||
            (i + 1 < all.size() && all[i + 1].time_s - all[i].time_s < 0.99 * cell_s);
        if (all[i].jump >= least_jump || !is_close) relevant.push_back(all[i]);
    }
    return relevant;
}

std::vector<Vec2> foci(const Modulation& modulation, double t_s) {
    const Vec2 middle = position(modulation.trajectory, t_s);
    std::vector<Vec2> places;
    for (const Vec2& offset : modulation.foci_m)
        places.push_back(middle + offset);
    if (places.empty()) places.push_back(middle);
    return places;
}

std::optional<double> modulation_frequency_Hz(const Modulation& modulation) {
    if (const double of_gain = gain_frequency_Hz(modulation.envelope); of_gain > 0.0)
        return of_gain;
    const double of_swing = swing_frequency_Hz(modulation.trajectory);
    return of_swing > 0.0 ? std::optional(of_swing) : std::nullopt;
}

} // namespace shearwake
