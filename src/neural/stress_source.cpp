// SPDX-License-Identifier: BSD-3-Clause
#include "neural/stress_source.hpp"

#include "neural/skin/resample.hpp"
#include "neural/skin/skin_ways.hpp"

#include <algorithm>

namespace shearwake::neural {

double dynamic_per_stress_rate(double depth_mm, double radius_mm) {
    return wave_gain(0.0, depth_mm, radius_mm) / stress_per_load(0.0, depth_mm, radius_mm);
}

StressSource::StressSource(Lines compression_MPa, double rate_Hz, double radius_mm)
    : radius_mm_(radius_mm),
      rates_MPa_s_(at_neuron_rate(load_rates_N_s(compression_MPa, rate_Hz), rate_Hz)) {
    stress_MPa_ = at_neuron_rate(compression_MPa, rate_Hz);
}

Drive StressSource::drive(std::span<const Afferent> afferents, std::size_t first) const {
    Drive drive{{}, Line(samples())};
    for (std::size_t i = 0; i < afferents.size(); ++i) {
        const double scale = dynamic_per_stress_rate(depth_mm(afferents[i].kind), radius_mm_);
        const auto rate = rates_MPa_s_.line(first + i);
        for (std::size_t k = 0; k < samples(); ++k)
            drive.dynamic_N_s_mm3[k][static_cast<std::ptrdiff_t>(i)] = scale * rate[k];
        if (!properties(afferents[i].kind).feels_static) continue;
        drive.static_MPa.resize(samples());
        const auto stress = stress_MPa_.line(first + i);
        for (std::size_t k = 0; k < samples(); ++k)
            drive.static_MPa[k][static_cast<std::ptrdiff_t>(i)] = stress[k];
    }
    return drive;
}

std::vector<Spikes> respond(const StressSource& source, std::span<const Afferent> afferents,
                            const RespondOptions& options) {
    return each_eight(afferents, options, [&](std::span<const Afferent> eight, std::size_t first) {
        return source.drive(eight, first);
    });
}

} // namespace shearwake::neural
