// SPDX-License-Identifier: BSD-3-Clause
#include "load/load.hpp"

#include "base/overloaded.hpp"
#include "load/load_pattern.hpp"

#include <cmath>
#include <numbers>

namespace shearwake {
double amplitude(const Load& load, double t_s) {
    const double c = std::visit(overloaded{
                                    [](const AveragedCarrier&) { return 1.0; },
                                    [&](const ResolvedCarrier& carrier) {
                                        return 1.0 + std::cos(2.0 * std::numbers::pi *
                                                              carrier.frequency_Hz * t_s);
                                    },
                                },
                                load.carrier);
    return gain(load.modulation.envelope, t_s) * c;
}

double held_s(const Load& load, double t_s) {
    const auto* array = std::get_if<ArrayFootprint>(&load.footprint);
    if (!array || array->update_rate_Hz == 0.0) return t_s;
    // A sample at the time of an update uses the new focus.
    return std::floor(t_s * array->update_rate_Hz + 1e-9) / array->update_rate_Hz;
}

std::vector<double> force_areas_m2(const Load& load, std::span<const double> times_s) {
    std::vector<double> areas;
    if (times_s.empty()) return areas;
    // The integral requires only few samples.
    LoadPattern pattern(load, times_s.back(), ArrayField::Sampling::coarse);
    const double k_zero = 0.0;
    for (const double t_s : times_s) {
        std::complex<double> area;
        if (pattern.changes()) pattern.set(pattern.held_s(t_s));
        if (pattern.changes() || areas.empty())
            pattern.spectra(0.0, {&k_zero, 1}, {&area, 1});
        else
            area = areas.back();
        areas.push_back(area.real());
    }
    return areas;
}

double force_N(const Load& load, double t_s) {
    if (t_s < 0.0 || t_s > off_time_s(load.modulation.trajectory)) return 0.0;
    return load.peak_Pa * force_areas_m2(load, {&t_s, 1}).front() * amplitude(load, t_s);
}

} // namespace shearwake
