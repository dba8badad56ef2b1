// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

namespace shearwake {

inline constexpr double two_pi = 2.0 * std::numbers::pi;

/// The value of a quantity that is not defined or not known.
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// A unit suffix of a key, and its conversion to SI.
struct Unit {
    std::string_view suffix;   // with its underscore: "_mm"
    double to_SI;              // factor
    std::string_view quantity; // the suggestion for a wrong unit lists units of the same quantity
};

/// In thousandths: from m to mm, from s to ms.
constexpr double milli(double value) {
    return 1e3 * value;
}

constexpr double to_radians(double angle_deg) {
    return angle_deg * std::numbers::pi / 180.0;
}
constexpr double to_degrees(double angle_rad) {
    return 180.0 / std::numbers::pi * angle_rad;
}

/// The unit suffix at the end of `key`, if any; the longest one that matches. Ratios, such as
/// "c_p_over_c_s", have none.
std::optional<Unit> unit_of(std::string_view key);

/// `key` without its unit suffix: "thickness_mm" becomes "thickness".
std::string_view without_unit(std::string_view key);

/// `key` in the SI unit of its quantity: "thickness_mm" -> "thickness_m".
std::string key_in_SI(std::string_view key);

/// The clock that measures durations; it is not affected by changes of the time of day.
using Clock = std::chrono::steady_clock;

inline double seconds_between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
}
inline double seconds_since(Clock::time_point began) {
    return seconds_between(began, Clock::now());
}

} // namespace shearwake
