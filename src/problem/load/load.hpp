// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/load/envelope.hpp"
#include "problem/load/footprint.hpp"
#include "problem/load/motion/trajectory.hpp"

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace shearwake {

/// A modulation: trajectory, envelope and foci. `kind` is its usual name ("AM-STM"), which has no
/// effect.
struct Modulation {
    std::string kind;
    Trajectory trajectory;
    Envelope envelope;
    /// Simultaneous foci relative to the moving point; they share the power of the single focus
    /// that is used if none are given.
    std::vector<Vec2> foci_m = {};
    bool operator==(const Modulation&) const = default;
};

/// The values of `am_wave` as the type of a key: the gains that are waves.
const char* am_wave_type();

/// Where the foci are at time t [m].
std::vector<Vec2> foci(const Modulation& modulation, double t_s);

/// The frequency of the first periodic part (envelope first, then trajectory), if there is one; a
/// single repeated path is not periodic in this sense [Hz].
std::optional<double> modulation_frequency_Hz(const Modulation& modulation);

/// The cycle-averaged pressure acts: c(t) = 1.
struct AveragedCarrier {
    static constexpr const char* name = "averaged";
    bool operator==(const AveragedCarrier&) const = default;
};
/// c(t) = 1 + cos(2 pi f t): mean 1, never negative.
struct ResolvedCarrier {
    static constexpr const char* name = "resolved";
    double frequency_Hz = 40e3;
    bool operator==(const ResolvedCarrier&) const = default;
};
using Carrier = std::variant<AveragedCarrier, ResolvedCarrier>;

/// The frequency of the carrier; 0 if it is averaged [Hz].
inline double carrier_frequency_Hz(const Carrier& carrier) {
    return std::visit(overloaded{[](const AveragedCarrier&) { return 0.0; },
                                 [](const ResolvedCarrier& c) { return c.frequency_Hz; }},
                      carrier);
}

/// Normal traction p(x, y, t) = peak G(x - x_f(t), y - y_f(t)) e(t) c(t) [Pa], positive into the
/// tissue, from t = 0 to off_time_s. With n simultaneous foci, each has 1/n of the peak. G of an
/// array depends on its focus, and the peak refers to a single focus directly below the centre.
struct Load {
    double peak_Pa = 0.0;
    Footprint footprint;
    Carrier carrier;
    Modulation modulation;
    bool operator==(const Load&) const = default;
};

/// e(t) c(t) at time t, also after the end of the path.
double amplitude(const Load& load, double t_s);

/// e(t) c(t) while the load is on, 0 before t = 0 and after the path has ended.
double strength(const Load& load, double t_s);

/// The time at which the focus that is active at t was selected [s]: an array updates it at its
/// update rate, other sources at all times.
double updated_s(const Load& load, double t_s);

/// Force divided by peak_Pa and by e(t) c(t), at each of these ascending times [m^2]. That of a
/// steered array is interpolated between positions of its focus, with an error of 1e-5 or less.
/// With rounded phases or an iterated hologram it fluctuates from one position to the next, and is
/// computed at `most_rough` of the times.
std::vector<double>
force_areas_m2(const Load& load, std::span<const double> times_s,
               std::size_t most_rough = std::numeric_limits<std::size_t>::max());

/// The force of the whole footprint at these ascending times [N]; 0 before t = 0 and after the path
/// has ended.
std::vector<double> forces_N(const Load& load, std::span<const double> times_s);

/// The period of a load that repeats for ever, or the reason why it has none.
struct LoadPeriod {
    double period_s = 0.0;
    std::string reason; // a sentence without a subject: "has ..."; empty: there is a period
};

/// The frequencies with which the parts of a load repeat [Hz]: of its paths, swings, speeds and
/// gains, of a resolved carrier, and of the updates of an array whose focus moves.
std::vector<double> frequencies_of(const Load& load);

/// Why a load does not repeat for ever: its path ends, or it rises or falls once. A sentence
/// without a subject: "has ..."; empty if it repeats, or is constant.
std::string aperiodicity_reason(const Load& load);

/// The least common period of these frequencies, up to `longest_s`: the shortest time that is a
/// whole number of periods of each, to 1e-6 of a period. A load whose path ends, which rises or
/// falls once, or which is constant, has none.
LoadPeriod least_period(const Load& load, double longest_s);

/// Where the focus is at time t [m]; an array moves its focus at its update rate.
Vec2 focus_m(const Load& load, double t_s);

/// An instant at which the load is not smooth: limits from both sides of its position and strength,
/// or of their first two derivatives in time, differ. Between two breaks the load is smooth.
struct Break {
    double time_s = 0.0;
    /// Change of the strength, or of the position in standard deviations of a Gaussian footprint
    /// times the strength, whichever is larger, at most 1; the same of the slopes, over `cell_s`;
    /// and of the curvatures, over its square.
    double jump = 0.0, kink = 0.0, bend = 0.0;
};

/// The breaks of a load in [from_s, to_s), ascending. Left out are those with a jump below 1e-4, a
/// kink below 1e-3 and a bend below 3e-3, and those without a jump that are less than `cell_s`
/// apart: the points of a sampled curve. Not collective.
std::vector<Break> breaks_of(const Load& load, double from_s, double to_s, double cell_s);

} // namespace shearwake
