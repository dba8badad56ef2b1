// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <string>

namespace shearwake {

/// What a number may be, in the unit of its key.
struct Range {
    double least = -std::numeric_limits<double>::infinity();
    double most = std::numeric_limits<double>::infinity();
    bool least_excluded = false;
    bool most_excluded = false;

    static constexpr Range any() { return {}; }
    static constexpr Range above(double least) { return {.least = least, .least_excluded = true}; }
    static constexpr Range at_least(double least) { return {.least = least}; }
    static constexpr Range between(double least, double most) {
        return {.least = least, .most = most};
    }
    static constexpr Range inside(double least, double most) { return {least, most, true, true}; }

    bool holds(double value) const;
    std::string words() const; // "above 0"
};

} // namespace shearwake
