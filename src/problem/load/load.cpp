// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/load.hpp"

#include "base/units.hpp"
#include "problem/load/load_pattern.hpp"
#include "problem/load/motion/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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
    return array.phase_levels == 0 && !array.frames &&
           (array.hologram == Hologram::superposition || foci < 2);
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

namespace {

/// The areas of a load at some times, and what they depend on.
struct ForceAreas {
    Footprint footprint;
    Trajectory trajectory;
    std::vector<Vec2> foci_m;
    std::vector<double> times_s;
    std::size_t most_rough = 0;
    std::vector<double> areas_m2;
};

std::vector<double> computed_areas_m2(const Load& load, std::span<const double> times_s,
                                      std::size_t most_rough) {
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

} // namespace

std::vector<double> force_areas_m2(const Load& load, std::span<const double> times_s,
                                   std::size_t most_rough) {
    if (times_s.empty()) return {};
    if (!std::holds_alternative<ArrayFootprint>(load.footprint))
        return computed_areas_m2(load, times_s, most_rough);
    // Patterns of an array take most of the time of a case whose spectra are known. A case needs
    // the areas at the times of its frames and of its impulse.
    static thread_local std::array<ForceAreas, 2> kept;
    static thread_local std::size_t newest = 0;
    const Modulation& modulation = load.modulation;
    for (const ForceAreas& each : kept)
        if (each.footprint == load.footprint && each.trajectory == modulation.trajectory &&
            each.foci_m == modulation.foci_m && std::ranges::equal(each.times_s, times_s) &&
            each.most_rough == most_rough)
            return each.areas_m2;
    newest = 1 - newest;
    kept[newest] = {load.footprint,    modulation.trajectory,
                    modulation.foci_m, {times_s.begin(), times_s.end()},
                    most_rough,        computed_areas_m2(load, times_s, most_rough)};
    return kept[newest].areas_m2;
}

std::vector<double> forces_N(const Load& load, std::span<const double> times_s) {
    std::vector<double> forces = force_areas_m2(load, times_s);
    for (std::size_t n = 0; n < forces.size(); ++n)
        forces[n] *= load.peak_Pa * strength(load, times_s[n]);
    return forces;
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
        auto [jump, kink, bend] = changes(before, after, width_m);
        if (const auto* array = std::get_if<ArrayFootprint>(&load.footprint);
            array && array->frames)
            jump = 1.0; // the pattern changes, also where its place does not
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

const char* am_wave_type() {
    static const std::string type = [] {
        std::string words;
        for_each_alternative(std::type_identity<Gain>{}, [&]<class G>(const G&) {
            if constexpr (requires { G::is_wave; })
                words += (words.empty() ? "word:" : "|") + std::string(G::name);
        });
        return words;
    }();
    return type.c_str();
}

std::optional<double> modulation_frequency_Hz(const Modulation& modulation) {
    if (const double of_gain = gain_frequency_Hz(modulation.envelope); of_gain > 0.0)
        return of_gain;
    const double of_swing = swing_frequency_Hz(modulation.trajectory);
    return of_swing > 0.0 ? std::optional(of_swing) : std::nullopt;
}

} // namespace shearwake
