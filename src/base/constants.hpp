// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <numbers>

namespace shearwake {

inline constexpr double two_pi = 2.0 * std::numbers::pi;

/// The value of a quantity that is not defined or not known.
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

} // namespace shearwake
