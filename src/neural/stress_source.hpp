// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "neural/respond.hpp"

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

} // namespace shearwake::neural
