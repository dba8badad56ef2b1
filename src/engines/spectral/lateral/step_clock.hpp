// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/units.hpp"

#include <array>
#include <cstddef>

namespace shearwake::spectral {

/// Phases of a step: transforms of strain planes; solves over depth (forces, the solve, the
/// update); transfer of strains and forces between pencils and planes; products (stresses and the
/// vectors of the iterations where the medium varies); the sponge; and the rest (load, sums over
/// the ranks).
enum class Phase { transforms, solves, transfer, products, sponge, rest };
constexpr std::size_t phase_count = 6;

/// Seconds of each phase on this rank, and an estimate of its memory traffic in bytes: each array
/// counts once per read and once per write, pencils are assumed to stay in the cache. A lap covers
/// the time since the previous one, so that the phases add up to the total. A lap costs about 30
/// ns.
class StepClock {
public:
    void start() { last_ = Clock::now(); }
    void lap(Phase phase, double bytes = 0.0) {
        const auto now = Clock::now();
        const auto at = static_cast<std::size_t>(phase);
        seconds_[at] += seconds_between(last_, now);
        bytes_[at] += bytes;
        last_ = now;
    }
    double seconds(std::size_t phase) const { return seconds_[phase]; }
    double bytes(std::size_t phase) const { return bytes_[phase]; }

private:
    Clock::time_point last_;
    std::array<double, phase_count> seconds_{}, bytes_{};
};

} // namespace shearwake::spectral
