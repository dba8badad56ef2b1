#include "model/modulation.hpp"

namespace shearwake {

std::optional<double> modulation_frequency_Hz(const Modulation& modulation) {
    if (const double of_gain = gain_frequency_Hz(modulation.envelope); of_gain > 0.0)
        return of_gain;
    const double of_swing = swing_frequency_Hz(modulation.trajectory);
    return of_swing > 0.0 ? std::optional(of_swing) : std::nullopt;
}

} // namespace shearwake
