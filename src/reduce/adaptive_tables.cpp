// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/derived_tables.hpp"

#include "base/units.hpp"
#include "sampling/next_points.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <set>

namespace shearwake::reduce {
namespace {

std::string text_of(const Setting& setting) {
    return std::visit(
        [&](const auto& v) {
            if constexpr (std::is_same_v<std::decay_t<decltype(v)>, double>)
                return fmt::format("{} = {:.9g}", setting.key, v);
            else
                return fmt::format("{} = {}", setting.key, v);
        },
        setting.value);
}

/// The values along an axis for one combination of the other swept values.
struct NamedCurve {
    std::string others; // as text
    std::string group;  // `others` without the keys that are searched together with this axis
    adapt::Curve values;
};

class Curves {
public:
    Curves(const storage::PlanIndex& plan, const Table& table) : plan_(plan), table_(table) {
        for (std::size_t i = 0; i < plan.cases.size(); ++i)
            row_of_[plan.cases[i].id] = i;
    }

    std::vector<double> points(const AdaptiveAxis& axis) const {
        std::set<double> points;
        for (const storage::IndexedCase& c : plan_.cases)
            for (const Setting& setting : c.settings)
                if (const double* x = std::get_if<double>(&setting.value);
                    x && setting.key == axis.key && !c.is_reference)
                    points.insert(*x);
        return {points.begin(), points.end()};
    }

    std::vector<NamedCurve> along(const AdaptiveAxis& axis, const std::vector<double>& x) const {
        const std::set<std::string> together = searched_with(axis);
        std::vector<NamedCurve> curves;
        std::map<std::string, std::size_t> curve_of;
        for (std::size_t i = 0; i < plan_.cases.size(); ++i) {
            if (plan_.cases[i].is_reference) continue;
            NamedCurve place;
            double at = not_a_number;
            for (const Setting& setting : plan_.cases[i].settings) {
                if (setting.key == axis.key) {
                    at = std::get<double>(setting.value);
                    continue;
                }
                append(place.others, setting);
                if (!together.contains(setting.key)) append(place.group, setting);
            }
            const auto [curve, is_new] = curve_of.try_emplace(place.others, curves.size());
            if (is_new) {
                place.values.assign(x.size(), not_a_number);
                curves.push_back(std::move(place));
            }
            const auto index = std::ranges::lower_bound(x, at) - x.begin();
            if (index < std::ssize(x))
                curves[curve->second].values[static_cast<std::size_t>(index)] = value(axis, i);
        }
        return axis.is_extremum() ? best_of_groups(axis, std::move(curves)) : curves;
    }

private:
    static void append(std::string& text, const Setting& setting) {
        text += (text.empty() ? "" : ", ") + text_of(setting);
    }

    /// The keys of the other axes that search the same extremum.
    std::set<std::string> searched_with(const AdaptiveAxis& axis) const {
        std::set<std::string> keys;
        for (const AdaptiveAxis& other : plan_.adaptive)
            if (axis.is_extremum() && other.goal == axis.goal && other.column == axis.column &&
                other.key != axis.key)
                keys.insert(other.key);
        return keys;
    }

    /// Of each group, the curve that contains the extremum.
    static std::vector<NamedCurve> best_of_groups(const AdaptiveAxis& axis,
                                                  std::vector<NamedCurve> curves) {
        const double sign = axis.goal == AdaptiveAxis::Goal::minimum ? -1.0 : 1.0;
        const auto best = [&](const NamedCurve& curve) {
            double largest = -std::numeric_limits<double>::infinity();
            for (const double v : curve.values)
                largest = std::fmax(largest, sign * v);
            return largest;
        };
        std::vector<NamedCurve> best_curves;
        for (NamedCurve& curve : curves) {
            const auto same = std::ranges::find(best_curves, curve.group, &NamedCurve::group);
            if (same == best_curves.end())
                best_curves.push_back(std::move(curve));
            else if (best(curve) > best(*same))
                *same = std::move(curve);
        }
        return best_curves;
    }

    double number(std::size_t row, const std::string& column) const {
        return valid_value(plan_, table_, row, column);
    }

    double value(const AdaptiveAxis& axis, std::size_t row) const {
        const double v = number(row, axis.column);
        if (axis.goal != AdaptiveAxis::Goal::crossing) return v;
        if (axis.has_level) return v - axis.level;
        const auto reference = row_of_.find(plan_.cases[row].reference_id);
        return reference == row_of_.end() ? not_a_number
                                          : v - number(reference->second, axis.column);
    }

    const storage::PlanIndex& plan_;
    const Table& table_;
    std::map<std::string, std::size_t> row_of_; // by id
};

std::string yes_or_no(double value, double limit) {
    return std::isnan(value) ? "" : value <= limit ? "yes" : "no";
}

/// Adds the intervals of the curves to the table, and a sentence on the largest error.
void add_errors(AdaptiveState& state, const std::vector<NamedCurve>& curves, Table& table) {
    const AdaptiveAxis& axis = state.axis;
    double largest = 0.0;
    std::size_t beyond = 0, unknown = 0;
    for (const NamedCurve& curve : curves) {
        const std::vector<double> errors = adapt::interpolation_errors(state.points, curve.values);
        for (std::size_t i = 0; i < errors.size(); ++i) {
            largest = std::fmax(largest, errors[i]);
            beyond += errors[i] > axis.tolerance;
            unknown += std::isnan(errors[i]);
            table.rows.push_back({axis.key, std::string(name_of(axis.goal)), axis.column,
                                  curve.others, state.points[i], state.points[i + 1], not_a_number,
                                  not_a_number, errors[i], yes_or_no(errors[i], axis.tolerance)});
        }
    }
    std::string sentence = fmt::format(
        "{}: {} points; the estimated error of {} between the points is at most {:.2g} (tolerance "
        "{:g})",
        axis.key, state.points.size(), axis.column, largest, axis.tolerance);
    if (beyond > 0)
        sentence += fmt::format("; {} intervals exceed the tolerance because of the limits most = "
                                "{} and smallest_step = {:g}",
                                beyond, axis.most, axis.smallest_step);
    if (unknown > 0)
        sentence += fmt::format("; {} intervals have no estimate for lack of values", unknown);
    state.sentences.push_back(sentence);
}

/// Adds the extrema or crossings of the curves to the table and as sentences.
void add_locations(AdaptiveState& state, const std::vector<NamedCurve>& curves, Table& table) {
    const AdaptiveAxis& axis = state.axis;
    const char* goal = name_of(axis.goal);
    for (const NamedCurve& curve : curves) {
        const auto found = adapt::locations(axis, state.points, curve.values);
        const std::string where = curve.others.empty() ? "" : ", " + curve.others;
        if (found.empty())
            state.sentences.push_back(
                fmt::format("{}: no {} of {}{}", axis.key, goal, axis.column, where));
        for (const adapt::Location& location : found) {
            const double uncertain =
                std::max(location.at - location.from, location.to - location.at);
            const bool is_end =
                axis.is_extremum() && (location.at == location.from || location.at == location.to);
            state.sentences.push_back(fmt::format(
                "{}: {} of {} at {:.9g} +- {:.2g}{}{}{}", axis.key, goal, axis.column, location.at,
                uncertain,
                axis.is_extremum() ? fmt::format(" with the value {:.6g}", location.value) : "",
                where, is_end ? " (an end of the interval: the extremum may be outside)" : ""));
            table.rows.push_back({axis.key, std::string(goal), axis.column, curve.others,
                                  location.from, location.to, location.at,
                                  axis.is_extremum() ? location.value : not_a_number, not_a_number,
                                  yes_or_no(uncertain, axis.tolerance * (1.0 + 1e-9))});
        }
    }
}

} // namespace

AdaptiveStates adaptive_states(const storage::PlanIndex& plan, const Table& table) {
    AdaptiveStates states;
    states.table.columns = {"key", "goal",     "column", "settings",        "from",
                            "to",  "location", "value",  "estimated_error", "within_tolerance"};
    const Curves curves(plan, table);
    for (const AdaptiveAxis& axis : plan.adaptive) {
        AdaptiveState state{axis, curves.points(axis), {}, {}};
        if (state.points.size() < 2) continue;
        const std::vector<NamedCurve> along = curves.along(axis, state.points);
        std::vector<adapt::Curve> values;
        for (const NamedCurve& curve : along)
            values.push_back(curve.values);
        state.next = adapt::next_points(axis, state.points, values);
        if (axis.goal == AdaptiveAxis::Goal::refine)
            add_errors(state, along, states.table);
        else
            add_locations(state, along, states.table);
        states.axes.push_back(std::move(state));
    }
    return states;
}

} // namespace shearwake::reduce
