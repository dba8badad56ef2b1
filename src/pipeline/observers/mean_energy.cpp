// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/observers/mean_energy.hpp"

#include "measures/window.hpp"

#include <numeric>

namespace shearwake::pipeline {
namespace {

/// The weight of each frame in a mean over the period window, with sum 1; none if no window fits.
std::vector<double> mean_weights(const Case& c) {
    const measures::PeriodWindow window = measures::period_window(
        c.measure, c.time, modulation_frequency_Hz(c.scene().load.modulation),
        off_time_s(c.scene().load.modulation.trajectory));
    if (!window.fits()) return {};
    std::vector<double> weights =
        measures::window_weights(c.time, window.from_s, window.to_s, window.edge_s);
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (double& weight : weights)
        weight /= total;
    return weights;
}

} // namespace

MeanEnergy::MeanEnergy(const Case& c, const Comm& team)
    : case_(c), team_(team), weights_(mean_weights(c)) {}

void MeanEnergy::begin(const engines::Slab& slab) {
    slab_ = slab;
    together(team_, [&] {
        if (!weights_.empty())
            rows_.assign(static_cast<std::size_t>(slab.x_count * case_.domain.ny), 0.0);
    });
}

void MeanEnergy::frame(const engines::Frame& frame) {
    if (frame.depth != 0 || weights_.empty()) return;
    const double weight = weights_[static_cast<std::size_t>(frame.number)];
    if (weight == 0.0) return;
    double* mean = rows_.data();
    for (std::ptrdiff_t i = 0; i < frame.u_z_m.rows(); ++i)
        for (const double u : frame.u_z_m.row(i))
            *mean++ += weight * u * u;
}

void MeanEnergy::save(StateWriter& state) {
    if (!weights_.empty()) state.put("mean_u2", surface_rows(case_.domain, slab_), rows_.data());
}

void MeanEnergy::restore(const StateReader& state) {
    if (!weights_.empty()) state.get("mean_u2", surface_rows(case_.domain, slab_), rows_.data());
}

} // namespace shearwake::pipeline
