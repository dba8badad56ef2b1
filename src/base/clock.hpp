// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace shearwake {

/// The clock that measures durations; it is not affected by changes of the time of day.
using Clock = std::chrono::steady_clock;

inline double seconds_between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
}
inline double seconds_since(Clock::time_point began) {
    return seconds_between(began, Clock::now());
}

} // namespace shearwake
