#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace shearwake::test {

/// The larger of the two; infinity when the new one is not finite, which std::max would pass over.
inline double worse(double worst, double value) {
    return std::isfinite(value) ? std::max(worst, value) : std::numeric_limits<double>::infinity();
}

} // namespace shearwake::test
