// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace shearwake {

/// Absorption of sound in air by ISO 9613-1 [dB/m] at this frequency, absolute temperature and
/// relative humidity (0 to 1), at 101.325 kPa.
double air_absorption_dB_m(double frequency_Hz, double temperature_K, double humidity);

} // namespace shearwake
