#pragma once

#include "neural/respond.hpp"

namespace shearwake::neural {

/// From the rate of the stress at a receptor, MPa/s, to the dynamic term of the neurons,
/// N/(s mm3): 1/mm. The model was fitted with the term 1/z^2 sum g Q of a pin's load rate Q, which
/// is no stress. Both hold right below the middle of a static pin on a half-space, whose load P
/// makes the stress P stress_per_load(0, z, a) and the term Q wave_gain(0, z, a): their ratio is
/// the scale,
///     pi a (1 + xi^2)^2 / (z^2 (1 + 3 xi^2)),   xi = z / a,
/// so that there, pressed slowly, a receptor fires alike for both. Far below the pin (xi >> 1) it
/// is pi / (3 a). It depends on the radius a of the pin that is compared with.
double dynamic_per_stress_rate(double depth_mm, double radius_mm);

/// What reaches receptors whose stress is known, a line an afferent [MPa], compression positive:
/// the stress itself for SA1, and for all the scale above times its rate of change. Waves are in
/// the stress already: nothing is delayed or weakened.
class StressSource {
public:
    StressSource(Lines compression_MPa, double rate_Hz, double radius_mm);
    /// Of at most eight afferents that stand in a row in the lines, from `first` on.
    Drive drive(std::span<const Afferent> afferents, std::size_t first) const;
    std::size_t samples() const { return stress_MPa_.samples; } // at the neurons' rate

private:
    double radius_mm_;
    Lines stress_MPa_, rates_MPa_s_; // at the neurons' rate
};

/// The spikes of every afferent, whose stresses are the lines in its order.
std::vector<Spikes> respond(const StressSource& source, std::span<const Afferent> afferents,
                            const RespondOptions& options);

} // namespace shearwake::neural
