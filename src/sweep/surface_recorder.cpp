#include "sweep/surface_recorder.hpp"

#include "base/error.hpp"
#include "measures/window.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <span>

namespace shearwake {
namespace {

/// Cubic Lagrange weights at offset x in [0, 1) between the second and the third of four samples.
std::array<double, 4> cubic_weights(double x) {
    return {-x * (x - 1.0) * (x - 2.0) / 6.0, (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
            -(x + 1.0) * x * (x - 2.0) / 2.0, (x + 1.0) * x * (x - 1.0) / 6.0};
}

std::ptrdiff_t frame_at(const Case& c, double t_s) {
    return std::clamp<std::ptrdiff_t>(std::llround(t_s / c.time.interval_s) - 1, 0,
                                      c.time.frames - 1);
}

/// Each frame's weight in a mean over the period window, 1 in all; none if no window fits.
std::vector<double> mean_weights(const Case& c) {
    const PeriodWindow window =
        period_window(c.measure, c.time, modulation_frequency_Hz(c.load.modulation),
                      off_time_s(c.load.modulation.trajectory));
    if (!window.fits()) return {};
    std::vector<double> weights = window_weights(c.time, window.from_s, window.to_s);
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (double& weight : weights)
        weight /= total;
    return weights;
}

constexpr std::size_t sum_count = 6, peak_count = 2, all_count = sum_count + peak_count;

/// Sums first, then peaks.
std::vector<double> flat(const std::vector<SurfaceSums>& frames) {
    std::vector<double> values;
    for (const SurfaceSums& s : frames)
        values.insert(values.end(),
                      {s.u, s.abs_u, s.u2, s.u4, s.focal_u2, s.focal_weight, s.peak, s.focal_peak});
    return values;
}

/// Adds the sums of another part of the surface, keeps the larger peaks.
void add(std::span<const double> part, std::vector<SurfaceSums>& frames) {
    for (std::size_t n = 0; n < frames.size(); ++n) {
        const auto p = part.subspan(n * all_count, all_count);
        SurfaceSums& s = frames[n];
        s = {s.u + p[0],
             s.abs_u + p[1],
             s.u2 + p[2],
             s.u4 + p[3],
             s.focal_u2 + p[4],
             s.focal_weight + p[5],
             std::max(s.peak, p[6]),
             std::max(s.focal_peak, p[7])};
    }
}

} // namespace

std::vector<std::ptrdiff_t> SurfaceRecorder::kept_frames(const Case& c) {
    std::vector<std::ptrdiff_t> kept;
    if (c.record.frames) {
        for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
            kept.push_back(n);
        return kept;
    }
    for (const double t_s : c.record.snapshots_s)
        kept.push_back(frame_at(c, t_s));
    std::sort(kept.begin(), kept.end());
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    return kept;
}

SurfaceRecorder::SurfaceRecorder(const Case& c, const Comm& team, CaseFileWriter* writer,
                                 std::function<void()> tick)
    : case_(c), team_(team), writer_(writer), tick_(std::move(tick)),
      region_(measured_region(c.domain)), instant_(frame_at(c, c.measure.at_s)),
      kept_(kept_frames(c)), mean_weights_(mean_weights(c)) {
    const auto frames = static_cast<std::size_t>(c.time.frames);
    for (const double depth_m : c.measure.depths_m)
        depths_.push_back({depth_m, std::vector<SurfaceSums>(frames)});
    for (const Vec2 at_m : c.record.traces_m)
        traces_.push_back({at_m, std::vector<double>(frames)});
    if (c.afferents && std::holds_alternative<PinInput>(c.afferents->input))
        for (const Vec2 at_m : c.afferents->pins_m)
            pins_.push_back({at_m, std::vector<double>(frames)});
}

void SurfaceRecorder::begin(const Slab& slab) {
    slab_ = slab;
    // All memory before the first frame: no rank may run out of it alone between two frames.
    together(team_, [&] {
        const auto samples = static_cast<std::size_t>(slab.x_count * case_.domain.ny);
        instant_rows_.reserve(samples);
        if (!mean_weights_.empty()) mean_rows_.assign(samples, 0.0);
    });
}

void SurfaceRecorder::frame(const Frame& frame) {
    const auto n = static_cast<std::size_t>(frame.number);
    const std::vector<Vec2> places = foci(case_.load.modulation, case_.time.frame_s(frame.number));
    depths_[frame.depth].frames[n] = surface_sums(frame.u_z_m, slab_.x_start, case_.domain, region_,
                                                  places, case_.measure.focal_radius_m);
    if (frame.depth == 0)
        for (std::vector<TraceSeries>* series : {&traces_, &pins_})
            for (TraceSeries& trace : *series)
                trace.u_m[n] = value_at(trace.at_m, frame.u_z_m);
    if (frame.depth == 0) add_to_mean(frame);
    if (frame.depth == 0 && frame.number == instant_) {
        instant_held_ = true;
        for (std::ptrdiff_t i = 0; i < frame.u_z_m.rows(); ++i) {
            const auto row = frame.u_z_m.row(i);
            instant_rows_.insert(instant_rows_.end(), row.begin(), row.end());
        }
    }
    const auto kept = std::lower_bound(kept_.begin(), kept_.end(), frame.number);
    if (writer_ && kept != kept_.end() && *kept == frame.number)
        writer_->write_surface(static_cast<std::size_t>(kept - kept_.begin()), frame.depth,
                               frame.u_z_m, slab_.x_start);
    if (tick_) tick_();
}

void SurfaceRecorder::volume_levels(const std::vector<double>& z_m) {
    if (writer_ && !case_.record.volumes_s.empty())
        writer_->begin_volume({.domain = case_.domain,
                               .times_s = case_.record.volumes_s,
                               .fields = case_.record.volume_fields,
                               .z_m = z_m},
                              slab_.x_count);
}

void SurfaceRecorder::volume(const VolumePlane& plane) {
    if (!writer_) return;
    writer_->write_volume(writer_->volume().variable(plane.field, plane.component), plane.snapshot,
                          plane.level, plane.values, slab_.x_start);
    volume_planes_ += 1.0;
}

void SurfaceRecorder::check_volumes() const {
    if (!writer_ || case_.record.volumes_s.empty()) return;
    const VolumeLayout& layout = writer_->volume();
    const auto wanted =
        static_cast<double>(layout.times_s.size() * layout.variables().size() * layout.z_m.size());
    if (wanted == 0.0 || volume_planes_ != wanted)
        throw CaseFailure(fmt::format("the engine gave {:.0f} of {:.0f} planes of the volumes",
                                      volume_planes_, wanted));
}

void SurfaceRecorder::save(StateWriter& state) {
    if (writer_) writer_->flush();
    state.put("recorder_ranks", team_.size());
    state.put("volume_planes", volume_planes_);
    const auto put_part = [&](const std::string& name, const std::vector<double>& part) {
        state.put(name, {team_.size(), team_.rank(), 1, static_cast<std::ptrdiff_t>(part.size())},
                  part.data());
    };
    for (std::size_t i = 0; i < depths_.size(); ++i)
        put_part(fmt::format("sums_{}", i), flat(depths_[i].frames));
    for (std::size_t i = 0; i < traces_.size(); ++i)
        put_part(fmt::format("trace_{}", i), traces_[i].u_m);
    if (!mean_weights_.empty()) state.put("mean_u2", surface_rows(), mean_rows_.data());
    for (std::size_t i = 0; i < pins_.size(); ++i)
        put_part(fmt::format("pin_{}", i), pins_[i].u_m);
    if (!stresses_.empty()) {
        std::vector<double> all;
        for (const TraceSeries& receptor : stresses_)
            all.insert(all.end(), receptor.u_m.begin(), receptor.u_m.end());
        put_part("stresses", all);
    }
    state.put("instant_held", instant_held_ ? 1.0 : 0.0);
    if (instant_held_) state.put("instant", surface_rows(), instant_rows_.data());
}

void SurfaceRecorder::restore(StateReader& state) {
    volume_planes_ = state.get("volume_planes");
    // On as many ranks each takes its own part again, on others several parts or none.
    const auto parts = static_cast<std::ptrdiff_t>(std::lround(state.get("recorder_ranks")));
    const std::ptrdiff_t first = parts * team_.rank() / team_.size();
    const std::ptrdiff_t count = parts * (team_.rank() + 1) / team_.size() - first;
    std::vector<double> mine;
    const auto get_parts = [&](const std::string& name, std::size_t length) {
        const auto row_length = static_cast<std::ptrdiff_t>(length);
        together(team_, [&] { mine.resize(static_cast<std::size_t>(count) * length); });
        state.get(name, {parts, first, count, row_length}, mine.data());
    };
    for (std::size_t i = 0; i < depths_.size(); ++i) {
        std::vector<SurfaceSums>& frames = depths_[i].frames;
        const std::size_t length = frames.size() * all_count;
        get_parts(fmt::format("sums_{}", i), length);
        std::fill(frames.begin(), frames.end(), SurfaceSums{});
        for (std::size_t at = 0; at < mine.size(); at += length)
            add(std::span(mine).subspan(at, length), frames);
    }
    const auto get_series = [&](const std::string& name, std::vector<double>& u) {
        get_parts(name, u.size());
        std::fill(u.begin(), u.end(), 0.0);
        for (std::size_t at = 0; at < mine.size(); ++at)
            u[at % u.size()] += mine[at];
    };
    for (std::size_t i = 0; i < traces_.size(); ++i)
        get_series(fmt::format("trace_{}", i), traces_[i].u_m);
    for (std::size_t i = 0; i < pins_.size(); ++i)
        get_series(fmt::format("pin_{}", i), pins_[i].u_m);
    if (!stresses_.empty()) {
        std::vector<double> all(stresses_.size() * static_cast<std::size_t>(case_.time.frames));
        get_series("stresses", all);
        auto next = all.begin();
        for (TraceSeries& receptor : stresses_) {
            const auto length = static_cast<std::ptrdiff_t>(receptor.u_m.size());
            std::copy_n(next, length, receptor.u_m.begin());
            next += length;
        }
    }
    if (!mean_weights_.empty()) state.get("mean_u2", surface_rows(), mean_rows_.data());
    instant_held_ = state.get("instant_held") != 0.0;
    if (!instant_held_) return;
    instant_rows_.resize(static_cast<std::size_t>(slab_.x_count * case_.domain.ny));
    state.get("instant", surface_rows(), instant_rows_.data());
}

double SurfaceRecorder::value_at(Vec2 at_m, View2<const double> values) const {
    const Domain& d = case_.domain;
    const double x = at_m.x / d.spacing_m + static_cast<double>(d.nx / 2);
    const double y = at_m.y / d.spacing_m + static_cast<double>(d.ny / 2);
    const double x_floor = std::floor(x + 1e-9), y_floor = std::floor(y + 1e-9);
    const auto wx = cubic_weights(std::max(0.0, x - x_floor));
    const auto wy = cubic_weights(std::max(0.0, y - y_floor));
    double sum = 0.0;
    for (std::ptrdiff_t a = 0; a < 4; ++a) {
        const std::ptrdiff_t i = (static_cast<std::ptrdiff_t>(x_floor) + a - 1 + d.nx) % d.nx;
        const std::ptrdiff_t row = i - slab_.x_start;
        if (row < 0 || row >= slab_.x_count) continue;
        for (std::ptrdiff_t b = 0; b < 4; ++b) {
            const std::ptrdiff_t j = (static_cast<std::ptrdiff_t>(y_floor) + b - 1 + d.ny) % d.ny;
            sum +=
                wx[static_cast<std::size_t>(a)] * wy[static_cast<std::size_t>(b)] * values(row, j);
        }
    }
    return sum;
}

void SurfaceRecorder::keep_stress(const std::vector<Vec2>& at_m, std::vector<std::size_t> depths) {
    together(team_, [&] {
        stress_depths_ = std::move(depths);
        for (const Vec2 place_m : at_m)
            stresses_.push_back(
                {place_m, std::vector<double>(static_cast<std::size_t>(case_.time.frames))});
    });
}

void SurfaceRecorder::stress(const StressFrame& frame) {
    for (std::size_t i = 0; i < stresses_.size(); ++i) {
        const Vec2 at_m = stresses_[i].at_m;
        if (stress_depths_[i] == frame.depth && case_.domain.holds(at_m))
            stresses_[i].u_m[static_cast<std::size_t>(frame.number)] =
                value_at(at_m, frame.compression_Pa);
    }
    if (tick_) tick_();
}

void SurfaceRecorder::add_to_mean(const Frame& frame) {
    if (mean_weights_.empty()) return;
    const double weight = mean_weights_[static_cast<std::size_t>(frame.number)];
    if (weight == 0.0) return;
    double* mean = mean_rows_.data();
    for (std::ptrdiff_t i = 0; i < frame.u_z_m.rows(); ++i)
        for (const double u : frame.u_z_m.row(i))
            *mean++ += weight * u * u;
}

void SurfaceRecorder::finish() {
    check_volumes();
    for (DepthSeries& depth : depths_) {
        std::vector<double> sums, peaks;
        for (const SurfaceSums& s : depth.frames) {
            sums.insert(sums.end(), {s.u, s.abs_u, s.u2, s.u4, s.focal_u2, s.focal_weight});
            peaks.insert(peaks.end(), {s.peak, s.focal_peak});
        }
        team_.sum(sums);
        team_.max(peaks);
        for (std::size_t n = 0; n < depth.frames.size(); ++n) {
            const double* s = &sums[n * sum_count];
            const double* p = &peaks[n * peak_count];
            depth.frames[n] = {s[0], s[1], s[2], s[3], s[4], s[5], p[0], p[1]};
            // Known to all ranks alike, so all of them throw.
            if (!std::isfinite(s[2]) || !std::isfinite(s[3]))
                throw CaseFailure(fmt::format(
                    "the field is not finite from t = {:.4g} ms on, at depth {:.3g} mm",
                    1e3 * case_.time.frame_s(static_cast<std::ptrdiff_t>(n)), 1e3 * depth.depth_m));
        }
    }
    for (std::vector<TraceSeries>* series : {&traces_, &pins_, &stresses_})
        for (TraceSeries& trace : *series)
            team_.sum(trace.u_m);
    mean_u2_ = team_.gather(mean_rows_);
    const std::vector<double> instant = team_.gather(instant_rows_);
    on_root(team_, [&] { fit_mach(instant); });
}

void SurfaceRecorder::fit_mach(const std::vector<double>& instant) {
    const Trajectory& trajectory = case_.load.modulation.trajectory;
    const double t_s = case_.time.frame_s(instant_);
    const std::string none = no_focus_reason(case_.measure, case_.time, off_time_s(trajectory));
    if (!none.empty() || !has_constant_velocity(trajectory) ||
        case_.load.modulation.foci_m.size() > 1) {
        mach_ = MachFit{};
        mach_->reason =
            none.empty()
                ? "no single focus that runs straight on at one speed: the wake has no single angle"
                : none;
        return;
    }
    const View2<const double> surface(instant.data(), case_.domain.nx, case_.domain.ny);
    mach_ = mach_angle(
        surface, case_.domain, position(trajectory, t_s), velocity(trajectory, t_s),
        rayleigh_speed_m_s(surface_wave_layer(case_.medium, fwhm_m(case_.load.footprint))),
        fwhm_m(case_.load.footprint), t_s);
}

} // namespace shearwake
