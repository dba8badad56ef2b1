// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/observers/instant_surface.hpp"

#include "measures/window.hpp"

namespace shearwake::pipeline {

InstantSurface::InstantSurface(const Case& c, const Comm& team)
    : case_(c), team_(team), instant_(frame_at(c, c.measure.at_s)) {}

void InstantSurface::begin(const engines::Slab& slab) {
    slab_ = slab;
    // Allocate all memory before the first frame, so that no rank alone can run out of memory
    // between two frames.
    together(team_,
             [&] { rows_.reserve(static_cast<std::size_t>(slab.x_count * case_.domain.ny)); });
}

void InstantSurface::frame(const engines::Frame& frame) {
    if (frame.depth != 0 || frame.number != instant_) return;
    is_held_ = true;
    for (std::ptrdiff_t i = 0; i < frame.u_z_m.rows(); ++i) {
        const auto row = frame.u_z_m.row(i);
        rows_.insert(rows_.end(), row.begin(), row.end());
    }
}

void InstantSurface::save(StateWriter& state) {
    state.put("instant_held", is_held_ ? 1.0 : 0.0);
    if (is_held_) state.put("instant", surface_rows(case_.domain, slab_), rows_.data());
}

void InstantSurface::restore(const StateReader& state) {
    is_held_ = state.get("instant_held") != 0.0;
    if (!is_held_) return;
    rows_.resize(static_cast<std::size_t>(slab_.x_count * case_.domain.ny));
    state.get("instant", surface_rows(case_.domain, slab_), rows_.data());
}

void InstantSurface::finish() {
    const std::vector<double> surface = team_.gather(rows_);
    on_root(team_, [&] { mach_ = fit(surface); });
}

measures::MachFit InstantSurface::fit(const std::vector<double>& surface) const {
    const Trajectory& trajectory = case_.scene().load.modulation.trajectory;
    const double t_s = case_.time.frame_s(instant_);
    const std::string none =
        measures::no_focus_reason(case_.measure, case_.time, off_time_s(trajectory));
    if (!none.empty() || !has_constant_velocity(trajectory) ||
        case_.scene().load.modulation.foci_m.size() > 1) {
        measures::MachFit fit;
        fit.reason = none.empty() ? "the wake has no single angle: this requires a single focus "
                                    "that moves along a straight line at constant speed"
                                  : none;
        return fit;
    }
    const double fwhm = fwhm_m(case_.scene().load.footprint);
    return measures::mach_angle(
        View2<const double>(surface.data(), case_.domain.nx, case_.domain.ny), case_.domain,
        position(trajectory, t_s), velocity(trajectory, t_s),
        rayleigh_speed_m_s(surface_wave_layer(case_.scene().medium, fwhm)), fwhm, t_s);
}

} // namespace shearwake::pipeline
