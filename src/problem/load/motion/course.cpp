// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/motion/trajectory.hpp"

#include "base/units.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shearwake {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// The stops of one pass and the times at which they are reached.
class Timetable {
public:
    explicit Timetable(const Travel& travel)
        : interior_m_(corners_m(travel.path)), length_m_(length_m(travel.path)),
          turns_back_(travel.at_end == AtEnd::back_and_forth),
          starts_(turns_back_ || starts_at_corner(travel.path)), pace_(travel.corners) {}

    double cycle_m() const { return turns_back_ ? 2.0 * length_m_ : length_m_; }
    bool starts_at_stop() const { return starts_; }

    std::ptrdiff_t count() const {
        const auto inside = std::ssize(interior_m_);
        return turns_back_ ? 2 + 2 * inside : inside + (starts_ ? 1 : 0);
    }

    double arc_m(std::ptrdiff_t stop) const {
        const auto inside = std::ssize(interior_m_);
        const auto corner = [&](std::ptrdiff_t i) {
            return interior_m_[static_cast<std::size_t>(i)];
        };
        if (starts_ && stop == 0) return 0.0;
        const std::ptrdiff_t i = starts_ ? stop - 1 : stop;
        if (i < inside) return corner(i);
        return i == inside ? length_m_ : 2.0 * length_m_ - corner(2 * inside - i);
    }

    /// The additional time of one slow half of a stop, multiplied by the speed: the distance d
    /// takes 2 d / (v (1 + rho)) at a speed that changes linearly between rho v and v, instead of d
    /// / v.
    double delay_m() const {
        return pace_.slow_within_m * (1.0 - pace_.slow_to) / (1.0 + pace_.slow_to);
    }
    double dwell_s() const { return pace_.dwell_s; }

    double arrival_s(std::ptrdiff_t stop, double speed_m_s) const {
        const auto passed = static_cast<double>(stop), halves = 2.0 * passed + (starts_ ? 0 : 1);
        return (arc_m(stop) + halves * delay_m()) / speed_m_s + passed * pace_.dwell_s;
    }

    double cycle_s(double speed_m_s) const {
        const auto stops = static_cast<double>(count());
        return (cycle_m() + 2.0 * stops * delay_m()) / speed_m_s + stops * pace_.dwell_s;
    }

private:
    std::span<const double> interior_m_;
    double length_m_;
    bool turns_back_, starts_;
    CornerPace pace_;
};

/// The number of stops reached by this time.
std::ptrdiff_t reached(const Timetable& table, double speed_m_s, double t_s) {
    std::ptrdiff_t low = 0, high = table.count();
    while (low < high) {
        const std::ptrdiff_t middle = (low + high) / 2;
        if (table.arrival_s(middle, speed_m_s) <= t_s)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/// Position within one pass, at constant speed between the stops.
PathProgress in_run(const Timetable& table, const CornerPace& pace, double speed_m_s, double t_s) {
    const double slow_m_s = pace.slow_to * speed_m_s;
    const double zone_m = pace.slow_to < 1.0 ? pace.slow_within_m : 0.0;
    const double zone_s = 2.0 * zone_m / (speed_m_s + slow_m_s);
    const double rate = zone_s > 0.0 ? (speed_m_s - slow_m_s) / zone_s : 0.0;
    // The distance between a stop and the position in its slow half at the time `t` before or after
    // it.
    const auto from_stop_m = [&](double t) { return slow_m_s * t + 0.5 * rate * t * t; };

    const std::ptrdiff_t next = reached(table, speed_m_s, t_s);
    const bool is_last = next == table.count();
    if (!is_last || table.starts_at_stop()) {
        const double left_s =
            (is_last ? table.cycle_s(speed_m_s) : table.arrival_s(next, speed_m_s)) - t_s;
        if (left_s >= 0.0 && left_s < zone_s)
            return {.arc_m = (is_last ? table.cycle_m() : table.arc_m(next)) - from_stop_m(left_s),
                    .speed_m_s = slow_m_s + rate * left_s,
                    .stage = 4 * next};
    }
    if (next == 0) return {.arc_m = speed_m_s * t_s, .speed_m_s = speed_m_s, .stage = -1};
    const double stop_m = table.arc_m(next - 1);
    const double elapsed_s = t_s - table.arrival_s(next - 1, speed_m_s) - pace.dwell_s;
    if (elapsed_s < 0.0) return {.arc_m = stop_m, .speed_m_s = 0.0, .stage = 4 * next + 1};
    if (elapsed_s < zone_s)
        return {.arc_m = stop_m + from_stop_m(elapsed_s),
                .speed_m_s = slow_m_s + rate * elapsed_s,
                .stage = 4 * next + 2};
    return {.arc_m = stop_m + zone_m + speed_m_s * (elapsed_s - zone_s),
            .speed_m_s = speed_m_s,
            .stage = 4 * next + 3};
}

/// The time at which an oscillating speed has covered the length [s].
double end_of_oscillating_s(const OscillatingSpeed& motion, double length_m) {
    if (motion.deviation_m_s == 0.0) return length_m / motion.mean_m_s;
    // s(t) = mean t + a bounded swing: the end lies within that swing of length / mean. If the
    // speed never becomes negative, s(t) is monotonic and bisection finds the crossing; otherwise,
    // steps of a hundredth of a period bracket the first crossing.
    const double mean = motion.mean_m_s;
    const double swing_s =
        2.0 * std::abs(motion.deviation_m_s) / (two_pi * motion.frequency_Hz * mean);
    double low = std::max(0.0, length_m / mean - swing_s), high = length_m / mean + swing_s;
    const double step = 0.01 / motion.frequency_Hz;
    const auto beyond = [&](double t) { return arc_length_m(Motion{motion}, t) >= length_m; };
    if (beyond(low)) return low;
    for (double t = low; t < high; t += step) {
        if (beyond(t + step)) {
            low = t;
            high = t + step;
            break;
        }
    }
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        (beyond(middle) ? high : low) = middle;
    }
    return high;
}

/// The time within a pass and the number of the pass; there and back are two halves of one.
PathProgress at_rest(const Travel& travel, const Rests& rests, double t_s) {
    const double run_s = rests.ends_s.back();
    PathProgress now;
    double within_s = t_s;
    if (runs_again(travel)) {
        const double runs = std::floor(t_s / run_s);
        within_s = t_s - runs * run_s;
        now.pass = travel.at_end == AtEnd::repeat ? runs : 0.5 * runs;
    }
    std::size_t rest = rests.at(within_s);
    if (now.pass != std::floor(now.pass)) { // on the way back, the rests follow in reverse
        rest = rests.ends_s.size() - 1;
        while (rest > 0 && run_s - within_s <= rests.ends_s[rest - 1])
            --rest;
    }
    now.arc_m = rests.arcs_m[rest];
    now.stage = static_cast<std::ptrdiff_t>(rest);
    return now;
}

/// Returns from the far end where the pass reverses.
PathProgress folded(const Travel& travel, PathProgress in_run) {
    const double length = length_m(travel.path);
    if (travel.at_end != AtEnd::back_and_forth || in_run.arc_m <= length) return in_run;
    in_run.arc_m = 2.0 * length - in_run.arc_m;
    in_run.speed_m_s = -in_run.speed_m_s;
    in_run.pass += 0.5;
    return in_run;
}

/// At constant speed, with rests and slow parts at the corners.
PathProgress with_stops(const Travel& travel, double speed_m_s, double t_s) {
    const Timetable table(travel);
    if (runs_again(travel) && !(table.cycle_m() > 0.0))
        return {}; // a repeated path that is a point
    const double run_s = table.cycle_s(speed_m_s);
    const double pass = runs_again(travel) ? std::floor(t_s / run_s) : 0.0;
    PathProgress now = in_run(table, travel.corners, speed_m_s, t_s - run_s * pass);
    now.pass = pass;
    return folded(travel, now);
}

PathProgress without_stops(const Travel& travel, double t_s) {
    PathProgress all = {.arc_m = arc_length_m(travel.motion, t_s),
                        .speed_m_s = speed_m_s(travel.motion, t_s)};
    if (runs_again(travel)) {
        const double pass_m = Timetable(travel).cycle_m();
        if (!(pass_m > 0.0)) return {}; // a repeated path that is a point
        all.pass = std::floor(all.arc_m / pass_m);
        all.arc_m -= pass_m * all.pass;
    }
    return folded(travel, all);
}

} // namespace

bool runs_again(const Travel& travel) {
    return travel.at_end == AtEnd::repeat || travel.at_end == AtEnd::back_and_forth;
}

double cycle_m(const Travel& travel) {
    return Timetable(travel).cycle_m();
}

std::ptrdiff_t stops(const Travel& travel) {
    return Timetable(travel).count();
}

double shortest_between_stops_m(const Travel& travel) {
    const Timetable table(travel);
    double shortest_m = never, before_m = 0.0;
    for (std::ptrdiff_t i = 0; i < table.count(); ++i) {
        const bool from_plain_end = i == 0 && !table.starts_at_stop();
        if (i > 0 || from_plain_end)
            shortest_m =
                std::min(shortest_m, (from_plain_end ? 2.0 : 1.0) * (table.arc_m(i) - before_m));
        before_m = table.arc_m(i);
    }
    if (table.count() == 0) return never;
    const double rest_m = table.cycle_m() - before_m;
    return std::min(shortest_m, table.starts_at_stop() ? rest_m : 2.0 * rest_m);
}

double cycle_s(const Travel& travel) {
    return std::visit(
        overloaded{[&](const ConstantSpeed& m) {
                       return m.speed_m_s > 0.0 ? Timetable(travel).cycle_s(m.speed_m_s) : never;
                   },
                   [&](const OscillatingSpeed& m) {
                       return m.mean_m_s > 0.0 ? end_of_oscillating_s(m, cycle_m(travel)) : never;
                   },
                   [&](const Rests& m) {
                       return m.ends_s.back() *
                              (travel.at_end == AtEnd::back_and_forth ? 2.0 : 1.0);
                   }},
        travel.motion);
}

double speed_of_cycle_m_s(const Travel& travel, double cycle_s) {
    const Timetable table(travel);
    const auto stops = static_cast<double>(table.count());
    return (table.cycle_m() + 2.0 * stops * table.delay_m()) /
           (cycle_s - stops * travel.corners.dwell_s);
}

PathProgress progress(const Travel& travel, double t_s) {
    const auto at_corners = [&](const ConstantSpeed& constant) {
        return constant.speed_m_s > 0.0 && travel.corners != CornerPace{}
                   ? with_stops(travel, constant.speed_m_s, t_s)
                   : without_stops(travel, t_s);
    };
    return std::visit(
        overloaded{at_corners, [&](const OscillatingSpeed&) { return without_stops(travel, t_s); },
                   [&](const Rests& rests) { return at_rest(travel, rests, t_s); }},
        travel.motion);
}

} // namespace shearwake
