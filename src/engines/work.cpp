// SPDX-License-Identifier: BSD-3-Clause
#include "engines/work.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace shearwake::engines {
namespace {

constexpr double most_apart = 4.0; // bound on a rate relative to the one assumed for this machine
constexpr int sweeps = 50;

/// The median ratio of measured to assumed seconds.
double slowness(const std::vector<MeasuredWork>& measured) {
    std::vector<double> ratios;
    for (const MeasuredWork& one : measured)
        ratios.push_back(one.seconds / time_s(one.work, {}));
    if (ratios.empty()) return 1.0;
    const auto middle = ratios.begin() + std::ssize(ratios) / 2;
    std::nth_element(ratios.begin(), middle, ratios.end());
    return *middle;
}

} // namespace

Case calibration_case(const std::vector<CalibrationLayer>& layers, double fwhm_m,
                      const Domain& domain, const TimeAxis& time) {
    Case c;
    for (const CalibrationLayer& layer : layers)
        c.scene().medium.layers.push_back(
            {.name = fmt::format("layer {}", c.scene().medium.layers.size()),
             .thickness_m = layer.thickness_m,
             .density_kg_m3 = 1000.0,
             .c_p_m_s = 1500.0,
             .c_s_m_s = layer.c_s_m_s,
             .loss = KelvinVoigt{layer.viscosity_Pa_s}});
    c.scene().medium.base = layers.back().thickness_m > 0.0 ? Base::rigid : Base::half_space;
    c.scene().load.peak_Pa = 100.0;
    c.scene().load.footprint = GaussianFootprint{fwhm_m};
    c.scene().load.modulation = {
        .kind = "linear",
        .trajectory = {{Travel{{{-1e-2, 0.0}, {1.0, 0.0}}, ConstantSpeed{5.0}}}},
        .envelope = {}};
    c.domain = domain;
    c.time = time;
    c.measure = {.at_s = time.duration_s(), .settled_after_s = 0.0, .focal_radius_m = fwhm_m};
    return c;
}

double time_s(const Work& work, const Rates& rates) {
    const auto known = rates.find(work.kind.name);
    return work.amount * (known != rates.end() ? known->second : work.kind.assumed_s);
}

double time_s(const std::vector<Work>& work, const Rates& rates) {
    double seconds = 0.0;
    for (const Work& part : work)
        seconds += time_s(part, rates);
    return seconds;
}

Rates solve_rates(const std::vector<MeasuredWork>& measured, Rates known) {
    const double speed = slowness(measured);
    for (int sweep = 0; sweep < sweeps; ++sweep)
        for (const MeasuredWork& one : measured) {
            double amount = 0.0, usual = 0.0, others_s = 0.0;
            for (const Work& part : one.work) {
                if (part.kind.name != one.kind) {
                    others_s += time_s(part, known);
                    continue;
                }
                amount += part.amount;
                usual = speed * part.kind.assumed_s;
            }
            if (!(amount > 0.0))
                throw Error("the calibration case contains no work of kind " + one.kind);
            known[one.kind] = std::clamp((one.seconds - others_s) / amount, usual / most_apart,
                                         usual * most_apart);
        }
    return known;
}

double share_from_memory(double touched_B, double in_cache_B, double in_memory_B) {
    return std::clamp(std::log(touched_B / in_cache_B) / std::log(in_memory_B / in_cache_B), 0.0,
                      1.0);
}

} // namespace shearwake::engines
