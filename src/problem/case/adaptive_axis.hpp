// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

namespace shearwake {

/// An axis of a sweep whose points are chosen by the results.
struct AdaptiveAxis {
    enum class Goal { refine, maximum, minimum, crossing };
    std::string key;
    Goal goal = Goal::refine;
    double first = 0.0, last = 0.0; // in the unit of the key
    std::string column;
    double tolerance = 0.0; // refine: in the unit of the column; otherwise: in that of the key
    /// refine: points are not closer than this, in the unit of the key.
    double smallest_step = 0.0;
    bool has_level = false; // crossing: of a level; otherwise of the value of the reference
    double level = 0.0;
    std::size_t initial = 9; // number of points of the first round, including both ends
    std::size_t most = 200;  // largest number of points
    bool operator==(const AdaptiveAxis&) const = default;

    bool is_extremum() const { return goal == Goal::maximum || goal == Goal::minimum; }
};

/// The name of a goal in a job: "refine", "maximum", "minimum" or "crossing".
constexpr const char* name_of(AdaptiveAxis::Goal goal) {
    constexpr const char* names[] = {"refine", "maximum", "minimum", "crossing"};
    return names[static_cast<std::size_t>(goal)];
}

} // namespace shearwake
