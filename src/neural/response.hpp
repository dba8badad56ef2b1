#pragma once

#include "neural/respond.hpp"
#include "neural/scene.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace shearwake::neural {

/// When each afferent fired, from the stimulus' beginning on [s]; conduction delay included if it
/// is asked for.
using SpikeTimes = std::vector<std::vector<double>>;

/// What pins make afferents `first` ... `first + count - 1` of the scene do, with the silence that
/// the options ask for around the stimulus; spikes before its beginning and after its end are left
/// out. The noise is keyed by `key` and by the afferent's number in the scene, so that any division
/// of a scene gives the same. Not collective.
SpikeTimes response_to_pins(const PinStimulus& stimulus, const Scene& scene, std::size_t first,
                            std::size_t count, const AfferentOptions& options, std::uint64_t key);

/// The same for afferents whose stress is known, a line each [MPa], compression positive, with the
/// scale of a pin of `radius_mm` (dynamic_per_stress_rate).
SpikeTimes response_to_stress(const Lines& compression_MPa, double rate_Hz, double radius_mm,
                              const Scene& scene, std::size_t first, std::size_t count,
                              const AfferentOptions& options, std::uint64_t key);

/// A class of afferents in numbers.
struct ClassResponse {
    AfferentClass kind = AfferentClass::PC;
    std::size_t afferents = 0, active = 0, spikes = 0; // active: with a spike
    std::size_t most_spikes = 0;                       // of one of them
    double mean_rate_Hz = 0.0;                         // of the active
    double spread_mm = 0.0;       // root of the mean square distance of spikes from the path
    double vector_strength = 0.0; // of each afferent, weighted by its spikes; see below
    double locking = 0.0;         // the same without chance
    double first_spike_ms = 0.0;  // of all of them
    bool operator==(const ClassResponse&) const = default;
};

/// Fewest spikes of an afferent that say whether it is locked: a burst of two or three shows the
/// neuron's own interval, and one alone nothing.
inline constexpr std::size_t fewest_for_locking = 5;

/// One entry a class that is among the afferents, in their order. NaN where there is nothing to
/// say: rates, spread and first spike without a spike; locking without a modulation (`frequency_Hz`
/// 0) or an afferent of 5 spikes, its vector strength without one of 2. That of n spikes is R =
/// |sum_k exp(2 pi i f t_k)| / n, and that of n random ones sqrt(pi/(4n)), 0.4 for five; so locking
/// is what is left without chance, the root of (n R^2 - 1)/(n - 1) (Vinck et al. 2010, NeuroImage
/// 51, eq. 14: the mean over pairs of spikes), the mean over all pairs that an afferent fires: that
/// the wave comes later further away does not count against it. 0 where the mean is negative.
std::vector<ClassResponse> class_responses(std::span<const Afferent> afferents,
                                           const SpikeTimes& times_s, double duration_s,
                                           double frequency_Hz,
                                           const std::function<double(Vec2)>& distance_mm);

} // namespace shearwake::neural
