// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/modulation.hpp"

namespace shearwake {

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
