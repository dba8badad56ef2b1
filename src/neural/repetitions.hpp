// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "neural/fibre/afferent.hpp"
#include "neural/skin/lines.hpp"

#include <cstddef>
#include <span>

// A stimulus that has always repeated. Neurons are integrated from rest, and the first repetition
// begins with a step. Spikes therefore count only after a run-in.

namespace shearwake::neural {

/// Number of repetitions before, within and after the time in which spikes count. By default the
/// stimulus occurs once, and all of its spikes count.
struct Repetitions {
    std::size_t run_in = 0, counted = 1, run_out = 0;
    std::size_t total() const { return run_in + counted + run_out; }
    /// Whether the stimulus has always repeated.
    bool is_periodic() const { return run_in > 0; }
};

/// Time after which the response to a periodic stimulus is independent of its start [s]: the travel
/// time of the waves, the currents that follow a spike, and eight time constants of the slowest
/// membrane, after which 3e-4 of its initial potential is left. 0.16 s with RA, 0.75 s with SA1.
double run_in_s(std::span<const Afferent> afferents);

/// The repetitions of a stimulus with this period [s] for `counted` periods of spikes: a run-in of
/// at least run_in_s(), and 10 ms at the end, where the resampling of the end of the stimulus
/// causes ringing.
Repetitions repetitions_of(std::span<const Afferent> afferents, double period_s,
                           std::size_t counted);

/// Every line repeated this many times.
Lines repeated(const Lines& lines, std::size_t times);

} // namespace shearwake::neural
