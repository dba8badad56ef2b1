// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace shearwake::test {

/// The larger value, or infinity if the new value is not finite, which std::max would ignore.
inline double worse(double worst, double value) {
    return std::isfinite(value) ? std::max(worst, value) : std::numeric_limits<double>::infinity();
}

} // namespace shearwake::test
