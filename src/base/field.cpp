// SPDX-License-Identifier: BSD-3-Clause
#include "base/field.hpp"

#include <cmath>
#include <fmt/format.h>

namespace shearwake {

bool Range::contains(double value) const {
    const bool enough = least_excluded ? value > least : value >= least;
    const bool little_enough = most_excluded ? value < most : value <= most;
    return enough && little_enough;
}

std::string Range::words() const {
    const bool bounded_below = std::isfinite(least), bounded_above = std::isfinite(most);
    if (bounded_below && bounded_above)
        return fmt::format("between {} and {}{}", least, most,
                           least_excluded && most_excluded ? ", both excluded"
                           : least_excluded                ? fmt::format(", {} excluded", least)
                           : most_excluded                 ? fmt::format(", {} excluded", most)
                                                           : "");
    if (bounded_below) return fmt::format("{} {}", least_excluded ? "above" : "at least", least);
    if (bounded_above) return fmt::format("{} {}", most_excluded ? "below" : "at most", most);
    return "a finite number";
}

} // namespace shearwake
