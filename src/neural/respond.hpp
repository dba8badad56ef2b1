#pragma once

#include "neural/afferent.hpp"
#include "neural/contact.hpp"
#include "neural/neuron.hpp"
#include "neural/skin_ways.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

namespace shearwake::neural {

struct RespondOptions {
    std::optional<std::uint64_t> noise_key; // none: no noise
    std::uint32_t first_number = 0;         // of the first afferent among all: noise follows it
    SkinWays ways;                          // from the pins; none: straight ones
};

/// What reaches eight receptors, at the neurons' rate.
struct Drive {
    Line static_MPa; // empty without an SA1 among them
    Line dynamic_N_s_mm3;
};

/// Loads and load rates of pins, and what of them reaches receptors: the wave of each pin's load
/// rate delayed, weakened and summed at the stimulus' own rate, and the static stress, which is
/// there at once and along the straight line.
class PinSource {
public:
    explicit PinSource(const PinStimulus& stimulus);
    /// Of at most eight afferents.
    Drive drive(std::span<const Afferent> afferents, const SkinWays& ways) const;
    const std::vector<Vec2>& at_mm() const { return at_mm_; }
    std::size_t samples() const { return samples_; } // at the neurons' rate

private:
    std::vector<Vec2> at_mm_;
    double radius_mm_, rate_Hz_;
    Lines rates_N_s_;      // at the stimulus' rate
    Lines static_loads_N_; // at the neurons' rate
    std::size_t samples_;
};

/// The samples at which an afferent fires.
using Spikes = std::vector<std::uint32_t>;

/// From the drive of at most eight afferents to their spikes.
std::array<Spikes, lane_count> fire(std::span<const Afferent> afferents, Drive drive,
                                    const RespondOptions& options, std::uint32_t first_number);

/// The spikes of all, eight at a time: drive_of(eight, first) is what reaches those that stand from
/// `first` on.
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

/// The spikes of every afferent that pins make. Not collective; the same for an afferent whichever
/// others there are, but for its number, which the noise follows.
std::vector<Spikes> respond(const PinStimulus& stimulus, std::span<const Afferent> afferents,
                            const RespondOptions& options);

} // namespace shearwake::neural
