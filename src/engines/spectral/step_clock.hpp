#pragma once

#include <array>
#include <chrono>
#include <cstddef>

namespace shearwake {

/// What a step's time goes to: transforms of strain planes; pencils over depth (forces, the banded
/// solve, the update); strains and forces between pencils and planes; stresses and the vectors of
/// the iterations where the medium varies; the sponge; what is left (the load, sums over the
/// ranks).
enum class Phase { transforms, solves, transfer, products, sponge, rest };
constexpr std::size_t phase_count = 6;

/// Seconds of each phase on this rank, and bytes moved from and to memory as the code counts them:
/// each array once for every time it is read and every time it is written, pencils not at all
/// (they stay in the cache). Each lap takes what has passed since the last one, so that the phases
/// sum to the whole; a lap costs about 30 ns.
class StepClock {
public:
    void start() { last_ = Clock::now(); }
    void lap(Phase phase, double bytes = 0.0) {
        const auto now = Clock::now();
        const auto at = static_cast<std::size_t>(phase);
        seconds_[at] += std::chrono::duration<double>(now - last_).count();
        bytes_[at] += bytes;
        last_ = now;
    }
    double seconds(std::size_t phase) const { return seconds_[phase]; }
    double bytes(std::size_t phase) const { return bytes_[phase]; }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point last_;
    std::array<double, phase_count> seconds_{}, bytes_{};
};

} // namespace shearwake
