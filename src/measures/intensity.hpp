#pragma once

#include "model/load.hpp"

namespace shearwake {

/// Delivered impulse: integral of the force over time from 0 to until_s [N s], zero after the path
/// has ended. Trapezoidal with 200 steps a period of the highest frequency on the force (carrier
/// included) and at least 256 in all, the last step ending exactly where the force does: within
/// 1e-4 / (cycles) of the oscillating part.
double impulse_N_s(const Load& load, double until_s);

} // namespace shearwake
