// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/observed_model.hpp"

#include "base/error.hpp"
#include "engines/registry/make_engine.hpp"
#include "parallel/agree.hpp"
#include "pipeline/observers/point_series.hpp"
#include "pipeline/vibrometer.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::laboratory {
namespace {

/// Memory of the motions that are kept, and their largest number: those of a derivative.
constexpr double most_cached_B = 2.5e8, most_cached = 16.0;
/// The case is continued by this fraction of its frames, so that a larger trigger delay does not
/// move the last samples out of it.
constexpr std::ptrdiff_t margin_share = 8, least_margin = 4;

/// The case whose displacements are those of `c` for a load of 1 Pa.
Case with_unit_load(Case c) {
    scene_of(c.problem).load.peak_Pa = 1.0;
    VibrometerOptions& scan = *c.vibrometer;
    scan.rate_Hz = scan.high_pass_Hz = scan.low_pass_Hz = scan.trigger_delay_s = 0.0;
    return c;
}

} // namespace

Case observed_case(Case c, const ConvertedData& data) {
    if (!c.vibrometer) {
        c.vibrometer.emplace();
        const Vec3 along = data.direction;
        c.vibrometer->tilt_rad = std::atan2(std::hypot(along.x, along.y), along.z);
        c.vibrometer->azimuth_rad = std::atan2(along.y, along.x);
        c.vibrometer->trigger_delay_s = data.delay_s;
    }
    VibrometerOptions& scan = *c.vibrometer;
    scan.points_m = data.points_m;
    for (const Vec2 nominal : data.points_m)
        if (const Vec2 point = nominal + Vec2{scan.offset_x_m, scan.offset_y_m};
            !c.domain.contains(point))
            throw UsageError(fmt::format(
                "the scan has a point at [{:.6g}, {:.6g}] mm outside of the domain of the job: "
                "enlarge domain.extent_mm, or correct the positions",
                1e3 * point.x, 1e3 * point.y));
    scan.rate_Hz = data.rate_Hz;
    scan.trigger_delay_s += data.start_s;
    scan.noise_m_s_rtHz = scan.missing_share = 0.0;
    c.record = {};
    c.afferents.reset();
    return c;
}

std::size_t covered_samples(const Case& observed, const ConvertedData& data) {
    const double duration_s = observed.time.duration_s();
    if (observed.time.regime == Regime::periodic) {
        const double samples = duration_s * data.rate_Hz;
        if (samples < 2.0 || std::abs(samples - std::round(samples)) > 1e-6 * samples)
            throw UsageError(fmt::format("the period of the load, {:.6g} ms, is not a whole number "
                                         "of samples at {:.6g} Hz: choose another sampling rate or "
                                         "modulation frequency",
                                         1e3 * duration_s, data.rate_Hz));
        return data.samples;
    }
    const double samples =
        std::floor((duration_s - observed.vibrometer->trigger_delay_s) * data.rate_Hz + 1e-9) + 1.0;
    return std::min(data.samples, static_cast<std::size_t>(std::max(samples, 0.0)));
}

ObservedModel::ObservedModel(const ConvertedData& data, std::size_t samples, const Comm& team)
    : data_(data), samples_(samples), team_(team) {}

std::vector<double> ObservedModel::velocities_m_s(const Case& given) {
    std::vector<double> rows;
    const Case c = continued(observed_case(given, data_));
    fail_together(team_, [&] {
        if (!engine_) engine_ = engines::make_engine(c.solver);
        std::vector<double> displacements_m = motion_m(with_unit_load(c));
        if (!team_.is_root()) return;
        for (double& value : displacements_m)
            value *= c.scene().load.peak_Pa;
        const pipeline::Scan scan = pipeline::scan(c, displacements_m);
        const std::size_t count = scan.time_s.size(); // one period, or at least all samples
        for (std::size_t point = 0; point < data_.points_m.size(); ++point)
            for (std::size_t n = 0; n < samples_; ++n)
                rows.push_back(scan.velocity_m_s[point * count + n % count]);
    });
    return rows;
}

Case ObservedModel::continued(Case c) {
    if (c.time.regime == Regime::periodic) return c;
    const double end_s =
        c.vibrometer->trigger_delay_s + static_cast<double>(samples_ - 1) / data_.rate_Hz;
    if (end_s > static_cast<double>(frames_) * c.time.interval_s)
        frames_ = std::max(c.time.frames,
                           static_cast<std::ptrdiff_t>(std::ceil(end_s / c.time.interval_s)) +
                               std::max(least_margin, c.time.frames / margin_share));
    c.time.frames = std::max(c.time.frames, frames_);
    return c;
}

const std::vector<double>& ObservedModel::motion_m(const Case& c) {
    const auto known = std::find_if(cached_.begin(), cached_.end(),
                                    [&](const Motion& motion) { return motion.of == c; });
    if (known != cached_.end()) {
        std::rotate(cached_.begin(), known, known + 1);
        return cached_.front().displacements_m;
    }
    pipeline::ScanSeries series(c, team_);
    engine_->run(c, team_, series, nullptr);
    series.finish();
    cached_.insert(cached_.begin(), {c, series.displacements_m()});
    const double motion_B = sizeof(double) * static_cast<double>(series.displacements_m().size());
    while (static_cast<double>(cached_.size()) >
           std::clamp(most_cached_B / motion_B, 1.0, most_cached))
        cached_.pop_back();
    return cached_.front().displacements_m;
}

} // namespace shearwake::laboratory
