// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/load/load.hpp"

namespace shearwake::measures {

/// Delivered impulse: integral of the force over time from 0 to until_s [N s], zero after the path
/// has ended. Gauss rule in at least 10000 steps, and 100 per period of the highest frequency
/// of the force (carrier included). The error is below 1e-5. With rounded phases or an iterated
/// hologram, the force fluctuates by about 1 % as an array is steered, and the error is about 1e-4.
double impulse_N_s(const Load& load, double until_s);

} // namespace shearwake::measures
