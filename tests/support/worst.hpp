// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shearwake::test {

/// The larger value, or infinity if the new value is not finite, which std::max would ignore.
inline double worse(double worst, double value) {
    return std::isfinite(value) ? std::max(worst, value) : std::numeric_limits<double>::infinity();
}

/// The largest difference of values from those expected, and the largest of these.
struct Deviation {
    double largest = 0.0, of = 0.0;

    void add(double value, double expected) {
        largest = worse(largest, std::abs(value - expected));
        of = worse(of, std::abs(expected));
    }
    /// Values that are those of `whole` from the element `start` on.
    template <class Part, class Whole>
    void add(const Part& part, const Whole& whole, std::size_t start = 0) {
        if (start + part.size() > whole.size()) largest = worse(largest, std::nan(""));
        for (std::size_t i = 0; i < std::min(part.size(), whole.size() - start); ++i)
            add(static_cast<double>(part[i]), static_cast<double>(whole[start + i]));
    }
    /// Not a number if all expected values are zero.
    double relative() const { return largest / of; }
    double relative(const Comm& world) const { return world.max(largest) / world.max(of); }
};

/// Largest difference of a part relative to the largest expected value.
template <class Part, class Whole>
double apart(const Part& part, const Whole& whole, std::size_t start = 0) {
    Deviation difference;
    difference.add(part, whole, start);
    for (const auto value : whole)
        difference.of = worse(difference.of, std::abs(static_cast<double>(value)));
    return difference.relative();
}

} // namespace shearwake::test
