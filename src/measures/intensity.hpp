// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "load/load.hpp"

namespace shearwake::measures {

/// Delivered impulse: integral of the force over time from 0 to until_s [N s], zero after the path
/// has ended. Trapezoidal rule with 200 steps per period of the highest frequency of the force
/// (carrier included) and at least 256 steps in total. The last step ends exactly where the force
/// does. The error is within 1e-4 / (cycles) of the oscillating part.
double impulse_N_s(const Load& load, double until_s);

} // namespace shearwake::measures
