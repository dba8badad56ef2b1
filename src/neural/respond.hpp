// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "neural/fibre/fibre.hpp"
#include "neural/skin/skin.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

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

namespace shearwake::neural {

/// Options of the response of a group of afferents.
struct RespondOptions {
    std::optional<std::uint64_t> noise_key; // empty: no noise
    /// Number of the first afferent in the scene, which determines its noise.
    std::uint32_t first_number = 0;
    SkinPaths paths; // distances from the pins; empty: straight lines
};

/// The input of eight receptors at the neurons' sampling rate.
struct Drive {
    Line static_MPa; // empty if there is no SA1
    Line dynamic_N_s_mm3;
};

/// Loads and load rates of pins, and their effect on receptors: the wave of each pin's load rate,
/// delayed, attenuated and summed at the sampling rate of the stimulus, and the static stress,
/// which acts instantly along the straight line. Not collective.
class PinSource {
public:
    explicit PinSource(const PinStimulus& stimulus);
    /// The input of at most eight afferents.
    Drive drive(std::span<const Afferent> afferents, const SkinPaths& paths) const;
    const std::vector<Vec2>& at_mm() const { return at_mm_; }
    std::size_t samples() const { return samples_; } // at the neurons' rate

private:
    std::vector<Vec2> at_mm_;
    double radius_mm_, rate_Hz_;
    Lines rates_N_s_;      // at the stimulus' rate
    Lines static_loads_N_; // at the neurons' rate
    std::size_t samples_;
};

/// The sample numbers at which an afferent fires, ascending.
using Spikes = std::vector<std::uint32_t>;

/// Computes the spikes of at most eight afferents from their input. Not collective.
std::array<Spikes, lane_count> fire(std::span<const Afferent> afferents, Drive drive,
                                    const RespondOptions& options, std::uint32_t first_number);

/// Computes the spikes of all afferents, eight at a time; drive_of(eight, first) returns the input
/// of the group that begins with index `first`.
template <class DriveOf>
std::vector<Spikes> each_eight(std::span<const Afferent> afferents, const RespondOptions& options,
                               const DriveOf& drive_of) {
    std::vector<Spikes> spikes;
    for (std::size_t first = 0; first < afferents.size(); first += lane_count) {
        const auto eight =
            afferents.subspan(first, std::min<std::size_t>(lane_count, afferents.size() - first));
        auto fired = fire(eight, drive_of(eight, first), options,
                          options.first_number + static_cast<std::uint32_t>(first));
        for (std::size_t i = 0; i < eight.size(); ++i)
            spikes.push_back(std::move(fired[i]));
    }
    return spikes;
}

/// The spikes of every afferent in response to pins. The result for an afferent depends on the
/// other afferents only through its number, which determines the noise. Not collective.
std::vector<Spikes> respond(const PinStimulus& stimulus, std::span<const Afferent> afferents,
                            const RespondOptions& options);

} // namespace shearwake::neural
