// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/acoustics/air.hpp"

#include <cmath>

namespace shearwake {

double air_absorption_dB_m(double frequency_Hz, double temperature_K, double humidity) {
    // ISO 9613-1, equations 3 to 5 and B.3, at the reference pressure.
    const double relative = temperature_K / 293.15;
    const double saturation = std::pow(10.0, -6.8346 * std::pow(273.16 / temperature_K, 1.261) +
                                                 4.6151); // partial pressure of water vapour
    const double water_percent = 100.0 * humidity * saturation;
    const double oxygen_Hz =
        24.0 + 4.04e4 * water_percent * (0.02 + water_percent) / (0.391 + water_percent);
    const double nitrogen_Hz =
        (9.0 + 280.0 * water_percent * std::exp(-4.170 * (std::cbrt(1.0 / relative) - 1.0))) /
        std::sqrt(relative);
    const double f2 = frequency_Hz * frequency_Hz;
    const auto relaxation = [&](double strength, double temperature, double at_Hz) {
        return strength * std::exp(-temperature / temperature_K) / (at_Hz + f2 / at_Hz);
    };
    return 8.686 * f2 *
           (1.84e-11 * std::sqrt(relative) +
            std::pow(relative, -2.5) *
                (relaxation(0.01275, 2239.1, oxygen_Hz) + relaxation(0.1068, 3352.0, nitrogen_Hz)));
}

} // namespace shearwake
