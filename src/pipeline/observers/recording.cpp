// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/observers/recording.hpp"

#include "base/error.hpp"
#include "measures/window.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace shearwake::pipeline {
namespace {

/// The sums of each frame for one kind of reduction, or for both.
std::vector<double> flat(const std::vector<measures::SurfaceSums>& frames, const auto& is_wanted) {
    std::vector<double> values;
    for (const measures::SurfaceSums& sums : frames)
        for (const auto& [value, reduction] : measures::sum_parts)
            if (is_wanted(reduction)) values.push_back(sums.*value);
    return values;
}

bool any(measures::Reduction) {
    return true;
}

} // namespace

FrameSums::FrameSums(const Case& c, const Comm& team)
    : Recording(c, team), region_(measures::measured_region(c.domain, c.measure)) {
    for (const double depth_m : c.measure.depths_m)
        depths_.push_back(
            {depth_m, std::vector<measures::SurfaceSums>(static_cast<std::size_t>(c.time.frames))});
}

void FrameSums::frame(const engines::Frame& frame) {
    const std::vector<Vec2> places =
        foci(case_.scene.load.modulation, case_.time.frame_s(frame.number));
    depths_[frame.depth].frames[static_cast<std::size_t>(frame.number)] = measures::surface_sums(
        frame.u_z_m, slab_.x_start, case_.domain, region_, places, case_.measure.focal_radius_m);
}

void FrameSums::save(StateWriter& state) {
    for (std::size_t i = 0; i < depths_.size(); ++i)
        RankParts(team_).save(state, fmt::format("sums_{}", i), flat(depths_[i].frames, any));
}

void FrameSums::restore(const StateReader& state) {
    for (std::size_t i = 0; i < depths_.size(); ++i) {
        std::vector<measures::SurfaceSums>& frames = depths_[i].frames;
        std::fill(frames.begin(), frames.end(), measures::SurfaceSums{});
        RankParts(team_).restore(state, fmt::format("sums_{}", i),
                                 frames.size() * measures::sum_parts.size(),
                                 [&](std::span<const double> part) {
                                     auto next = part.begin();
                                     for (measures::SurfaceSums& sums : frames) {
                                         measures::SurfaceSums more;
                                         for (const auto& [value, reduction] : measures::sum_parts)
                                             more.*value = *next++;
                                         sums = measures::combine(sums, more);
                                     }
                                 });
    }
}

void FrameSums::finish() {
    for (measures::DepthSeries& depth : depths_) {
        for (const measures::Reduction wanted :
             {measures::Reduction::sum, measures::Reduction::max}) {
            std::vector<double> values = flat(
                depth.frames, [&](measures::Reduction reduction) { return reduction == wanted; });
            wanted == measures::Reduction::sum ? team_.sum(values) : team_.max(values);
            auto next = values.begin();
            for (measures::SurfaceSums& sums : depth.frames)
                for (const auto& [value, reduction] : measures::sum_parts)
                    if (reduction == wanted) sums.*value = *next++;
        }
        for (std::size_t n = 0; n < depth.frames.size(); ++n)
            // All ranks have the same values, so all of them throw.
            if (!std::isfinite(depth.frames[n].u2) || !std::isfinite(depth.frames[n].u4))
                throw FieldDiverges(fmt::format(
                    "the field is not finite from t = {:.4g} ms, at depth {:.3g} mm",
                    1e3 * case_.time.frame_s(static_cast<std::ptrdiff_t>(n)), 1e3 * depth.depth_m));
    }
}

namespace {

/// The weight of each frame in a mean over the period window, with sum 1; none if no window fits.
std::vector<double> mean_weights(const Case& c) {
    const measures::PeriodWindow window =
        measures::period_window(c.measure, c.time, modulation_frequency_Hz(c.scene.load.modulation),
                                off_time_s(c.scene.load.modulation.trajectory));
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
    : Recording(c, team), weights_(mean_weights(c)) {}

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

SensationLevels::SensationLevels(const Case& c, const Comm& team) : Recording(c, team) {
    const auto& depths_m = c.measure.depths_m;
    surface_ = static_cast<std::size_t>(std::ranges::find(depths_m, 0.0) - depths_m.begin());
}

void SensationLevels::begin(const engines::Slab& slab) {
    together(team_, [&] { sums_.emplace(case_, slab.x_start, slab.x_count); });
}

void SensationLevels::frame(const engines::Frame& frame) {
    if (frame.depth == surface_) sums_->add(frame.number, frame.u_z_m);
}

DistributedRows SensationLevels::rows() const {
    return {sums_->all_rows(), sums_->first_row(), sums_->row_count(), sums_->row_length()};
}

void SensationLevels::save(StateWriter& state) {
    sums_->flush();
    if (sums_->row_length() > 0) state.put("sensation", rows(), sums_->sums());
}

void SensationLevels::restore(const StateReader& state) {
    if (sums_->row_length() > 0) state.get("sensation", rows(), sums_->sums());
}

void SensationLevels::finish() {
    measures::SensationMap mine;
    together(team_, [&] { mine = sums_->levels(); });
    map_ = {.x0 = mine.x0, .y0 = mine.y0, .rows = sums_->all_rows()};
    map_.level_dB = team_.gather(mine.level_dB);
    map_.band_Hz = team_.gather(mine.band_Hz);
    map_.sum_dB = team_.gather(mine.sum_dB);
    map_.columns =
        map_.level_dB.empty() ? 0 : static_cast<std::ptrdiff_t>(map_.level_dB.size()) / map_.rows;
    sums_.reset();
}

std::ptrdiff_t frame_at(const Case& c, double t_s) {
    return std::clamp<std::ptrdiff_t>(std::llround(t_s / c.time.interval_s) - 1, 0,
                                      c.time.frames - 1);
}

void RankParts::save_ranks(StateWriter& state) const {
    state.put("recorder_ranks", team_.size());
}

void RankParts::save(StateWriter& state, const std::string& name,
                     const std::vector<double>& mine) const {
    state.put(name, {team_.size(), team_.rank(), 1, static_cast<std::ptrdiff_t>(mine.size())},
              mine.data());
}

void RankParts::restore(const StateReader& state, const std::string& name, std::size_t length,
                        const std::function<void(std::span<const double>)>& take) const {
    const auto parts = static_cast<std::ptrdiff_t>(std::lround(state.get("recorder_ranks")));
    const std::ptrdiff_t first = parts * team_.rank() / team_.size();
    const std::ptrdiff_t count = parts * (team_.rank() + 1) / team_.size() - first;
    std::vector<double> mine;
    together(team_, [&] { mine.resize(static_cast<std::size_t>(count) * length); });
    state.get(name, {parts, first, count, static_cast<std::ptrdiff_t>(length)}, mine.data());
    for (std::size_t at = 0; at < mine.size(); at += length)
        take(std::span(mine).subspan(at, length));
}

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

void SurfaceFrames::begin(const engines::Slab& slab) {
    Recording::begin(slab);
    together(team_, [&] {
        all_.resize(static_cast<std::size_t>(case_.time.frames * slab.x_count * case_.domain.ny));
    });
}

void SurfaceFrames::frame(const engines::Frame& frame) {
    if (frame.depth != 0) return;
    float* out = all_.data() + frame.number * slab_.x_count * case_.domain.ny;
    for (std::ptrdiff_t i = 0; i < frame.u_z_m.rows(); ++i)
        for (const double value : frame.u_z_m.row(i))
            *out++ = static_cast<float>(value);
}

void SurfaceFrames::finish() {
    if (team_.size() == 1) return;
    const std::ptrdiff_t ny = case_.domain.ny, frames = case_.time.frames;
    const std::vector<long> starts = team_.gather(std::vector<long>{slab_.x_start}),
                            counts = team_.gather(std::vector<long>{slab_.x_count});
    const std::vector<float> parts = team_.gather(all_);
    together(team_, [&] {
        all_.resize(team_.is_root() ? static_cast<std::size_t>(frames * case_.domain.nx * ny) : 0);
        const float* from = parts.data();
        for (std::size_t rank = 0; rank < starts.size(); ++rank)
            for (std::ptrdiff_t n = 0; n < frames; ++n) {
                float* to = all_.data() + (n * case_.domain.nx + starts[rank]) * ny;
                std::copy_n(from, counts[rank] * ny, to);
                from += counts[rank] * ny;
            }
    });
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
    const Trajectory& trajectory = case_.scene.load.modulation.trajectory;
    const double t_s = case_.time.frame_s(instant_);
    const std::string none =
        measures::no_focus_reason(case_.measure, case_.time, off_time_s(trajectory));
    if (!none.empty() || !has_constant_velocity(trajectory) ||
        case_.scene.load.modulation.foci_m.size() > 1) {
        measures::MachFit fit;
        fit.reason = none.empty() ? "the wake has no single angle: this requires a single focus "
                                    "that moves along a straight line at constant speed"
                                  : none;
        return fit;
    }
    const double fwhm = fwhm_m(case_.scene.load.footprint);
    return measures::mach_angle(
        View2<const double>(surface.data(), case_.domain.nx, case_.domain.ny), case_.domain,
        position(trajectory, t_s), velocity(trajectory, t_s),
        rayleigh_speed_m_s(surface_wave_layer(case_.scene.medium, fwhm)), fwhm, t_s);
}

} // namespace shearwake::pipeline
