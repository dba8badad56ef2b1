// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "neural/hand/hand.hpp"
#include "neural/respond.hpp"

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace shearwake::neural {

/// Factor [1/mm] from the rate of the stress at a receptor, MPa/s, to the dynamic term of the
/// neurons, N/(s mm3). The model was fitted with the term 1/z^2 sum g Q of a pin's load rate Q,
/// which is not a stress. Below the centre of a static pin on a half-space, whose load P causes the
/// stress P stress_per_load(0, z, a) and the term Q wave_gain(0, z, a), the ratio of both is the
/// factor,
///     pi a (1 + xi^2)^2 / (z^2 (1 + 3 xi^2)),   xi = z / a,
/// so that a receptor there responds equally to both descriptions of slow pressing. Far below the
/// pin (xi >> 1) it is pi / (3 a). It depends on the radius a of the pin used for the comparison.
double dynamic_per_stress_rate(double depth_mm, double radius_mm);

/// Input of receptors with given stresses, one line per afferent [MPa], positive in compression:
/// the stress itself for SA1, and for all classes its rate of change times
/// dynamic_per_stress_rate(). The stress already contains the waves, so that no delay or
/// attenuation is applied. Not collective.
class StressSource {
public:
    StressSource(Lines compression_MPa, double rate_Hz, double radius_mm);
    /// Input of at most eight consecutive afferents, beginning with line `first`.
    Drive drive(std::span<const Afferent> afferents, std::size_t first) const;
    std::size_t samples() const { return stress_MPa_.samples; } // at the neurons' rate

private:
    double radius_mm_;
    Lines stress_MPa_, rates_MPa_s_; // at the neurons' rate
};

/// The spikes of every afferent; the lines of stress are in the same order. Not collective.
std::vector<Spikes> respond(const StressSource& source, std::span<const Afferent> afferents,
                            const RespondOptions& options);

/// Spike times of each afferent since the start of the counted time [s], including the conduction
/// delay if requested.
using SpikeTimes = std::vector<std::vector<double>>;

/// The part of a stimulus whose spikes count, after its start [s].
struct CountedTime {
    double from_s = 0.0;
    double to_s = std::numeric_limits<double>::infinity(); // at most its end
};

/// The response of afferents `first` to `first + count - 1` of the scene to pins. The stimulus is
/// surrounded by the silence of the options; spikes outside the counted time are discarded, and the
/// times of the others are relative to its beginning. The noise depends on `key` and on the
/// afferent's number in the scene, so that any division of a scene yields the same result. Throws
/// UsageError for an invalid stimulus. Not collective.
SpikeTimes response_to_pins(const PinStimulus& stimulus, const Scene& scene, std::size_t first,
                            std::size_t count, const AfferentOptions& options, std::uint64_t key,
                            const CountedTime& counted = {});

/// The response to given stresses, one line per afferent [MPa], positive in compression, with the
/// scale for a pin of `radius_mm` (see dynamic_per_stress_rate()). Throws UsageError for invalid
/// stresses. Not collective.
SpikeTimes response_to_stress(const Lines& compression_MPa, double rate_Hz, double radius_mm,
                              const Scene& scene, std::size_t first, std::size_t count,
                              const AfferentOptions& options, std::uint64_t key,
                              const CountedTime& counted = {});

/// Summary of the response of one class of afferents.
struct ClassResponse {
    AfferentClass kind = AfferentClass::PC;
    std::size_t afferents = 0, active = 0, spikes = 0; // active: with at least one spike
    std::size_t most_spikes = 0;                       // maximum of one afferent
    double mean_rate_Hz = 0.0;                         // mean over the active afferents
    double total_rate_Hz = 0.0; // spikes per second of all afferents of the class
    double peak_rate_Hz = 0.0;  // the same in the 50 ms with most spikes
    double near_share = 0.0;    // fraction of the spikes whose receptors are near the path
    double spread_mm = 0.0;     // root mean square distance of the spikes' receptors from the path
    double vector_strength = 0.0; // mean over the afferents, weighted by their spikes
    double locking = 0.0;         // vector strength without the contribution of chance
    double first_spike_ms = 0.0;  // first spike of the class
    bool operator==(const ClassResponse&) const = default;
};

/// Minimum number of spikes of an afferent for an estimate of its locking. A burst of two or three
/// spikes shows the neuron's own interval.
inline constexpr std::size_t fewest_for_locking = 5;

/// One entry per class that occurs among the afferents, in the order of classes. Undefined values
/// are NaN: rates, spread and first spike without spikes; locking without a modulation
/// (`frequency_Hz` is 0) or without an afferent with 5 spikes; vector strength without an afferent
/// with 2 spikes; the peak rate of less than 50 ms. `near_mm` is the distance up to which receptors
/// are near the path. The vector strength of n spikes is R = |sum_k exp(2 pi i f t_k)| / n; its
/// expectation for random spikes is sqrt(pi/(4n)), which is 0.4 for five spikes. Locking removes
/// this bias: it is the square root of (n R^2 - 1)/(n - 1), the mean over pairs of spikes (Vinck et
/// al. 2010, NeuroImage 51, eq. 14), averaged over the pairs of each afferent; 0 if the mean is
/// negative. Since only spikes of the same afferent are paired, the later arrival of the wave at
/// distant receptors does not reduce it. Not collective.
std::vector<ClassResponse> class_responses(std::span<const Afferent> afferents,
                                           const SpikeTimes& times_s, double duration_s,
                                           double frequency_Hz, double near_mm,
                                           const std::function<double(Vec2)>& distance_mm);

/// The window of the peak rate.
inline constexpr double peak_window_s = 0.05;

} // namespace shearwake::neural
