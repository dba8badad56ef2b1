// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/observers/stored_fields.hpp"

#include "base/error.hpp"
#include "measures/window.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::pipeline {

std::vector<std::ptrdiff_t> recorded_frames(const Case& c) {
    std::vector<std::ptrdiff_t> stored;
    if (c.record.frames) {
        for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
            stored.push_back(n);
        return stored;
    }
    for (const double t_s : c.record.snapshots_s)
        stored.push_back(frame_at(c, t_s));
    std::sort(stored.begin(), stored.end());
    stored.erase(std::unique(stored.begin(), stored.end()), stored.end());
    return stored;
}

StoredFields::StoredFields(const Case& c, const Comm& team, storage::CaseFileWriter& writer)
    : Recording(c, team), writer_(writer), frames_(recorded_frames(c)) {}

void StoredFields::frame(const engines::Frame& frame) {
    const auto stored = std::lower_bound(frames_.begin(), frames_.end(), frame.number);
    if (stored != frames_.end() && *stored == frame.number)
        writer_.write_surface(static_cast<std::size_t>(stored - frames_.begin()), frame.depth,
                              frame.u_z_m, slab_.x_start);
}

void StoredFields::volume_levels(const std::vector<double>& z_m) {
    if (!case_.record.volumes_s.empty())
        writer_.begin_volume({.domain = case_.domain,
                              .times_s = case_.record.volumes_s,
                              .fields = case_.record.volume_fields,
                              .z_m = z_m},
                             slab_.x_count);
}

void StoredFields::volume(const engines::VolumePlane& plane) {
    writer_.write_volume(writer_.volume().variable(plane.field, plane.component), plane.snapshot,
                         plane.level, plane.values, slab_.x_start);
    volume_planes_ += 1.0;
}

void StoredFields::save(StateWriter& state) {
    writer_.flush();
    state.put("volume_planes", volume_planes_);
}

void StoredFields::restore(const StateReader& state) {
    volume_planes_ = state.get("volume_planes");
}

void StoredFields::finish() {
    if (case_.record.volumes_s.empty()) return;
    const storage::VolumeLayout& layout = writer_.volume();
    const auto wanted =
        static_cast<double>(layout.times_s.size() * layout.variables().size() * layout.z_m.size());
    if (wanted == 0.0 || volume_planes_ != wanted)
        throw CaseFailure(fmt::format("the engine provided {:.0f} of {:.0f} planes of the volumes",
                                      volume_planes_, wanted));
}

InstantSurface::InstantSurface(const Case& c, const Comm& team)
    : Recording(c, team), instant_(frame_at(c, c.measure.at_s)) {}

void InstantSurface::begin(const engines::Slab& slab) {
    slab_ = slab;
    // Allocate all memory before the first frame, so that no rank alone can run out of memory
    // between two frames.
    together(team_,
             [&] { rows_.reserve(static_cast<std::size_t>(slab.x_count * case_.domain.ny)); });
}

void InstantSurface::frame(const engines::Frame& frame) {
    if (frame.depth != 0 || frame.number != instant_) return;
    has_instant_ = true;
    for (std::ptrdiff_t i = 0; i < frame.u_z_m.rows(); ++i) {
        const auto row = frame.u_z_m.row(i);
        rows_.insert(rows_.end(), row.begin(), row.end());
    }
}

void InstantSurface::save(StateWriter& state) {
    state.put("instant_held", has_instant_ ? 1.0 : 0.0);
    if (has_instant_) state.put("instant", surface_rows(case_.domain, slab_), rows_.data());
}

void InstantSurface::restore(const StateReader& state) {
    has_instant_ = state.get("instant_held") != 0.0;
    if (!has_instant_) return;
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
