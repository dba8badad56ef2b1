// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/observers/recording.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <numbers>

namespace shearwake::pipeline {

namespace {

/// Cubic Lagrange weights at offset x in [0, 1) between the second and the third of four samples.
std::array<double, 4> cubic_weights(double x) {
    return {-x * (x - 1.0) * (x - 2.0) / 6.0, (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
            -(x + 1.0) * x * (x - 2.0) / 2.0, (x + 1.0) * x * (x - 1.0) / 6.0};
}

std::vector<measures::TraceSeries> empty_series(const std::vector<Vec2>& at_m,
                                                const TimeAxis& time) {
    std::vector<measures::TraceSeries> series;
    for (const Vec2 place_m : at_m)
        series.push_back({place_m, std::vector<double>(static_cast<std::size_t>(time.frames))});
    return series;
}

/// Adds the contributions of this rank.
void restore_sum(const StateReader& state, const Comm& team, const std::string& name,
                 std::vector<double>& values) {
    std::fill(values.begin(), values.end(), 0.0);
    RankParts(team).restore(state, name, values.size(), [&](std::span<const double> part) {
        std::transform(values.begin(), values.end(), part.begin(), values.begin(), std::plus<>());
    });
}

} // namespace

double value_at(Vec2 at_m, View2<const double> values, const Domain& domain,
                const engines::Slab& slab) {
    const double x = at_m.x / domain.spacing_m + static_cast<double>(domain.nx / 2);
    const double y = at_m.y / domain.spacing_m + static_cast<double>(domain.ny / 2);
    const double x_floor = std::floor(x + 1e-9), y_floor = std::floor(y + 1e-9);
    const auto wx = cubic_weights(std::max(0.0, x - x_floor));
    const auto wy = cubic_weights(std::max(0.0, y - y_floor));
    double sum = 0.0;
    for (std::ptrdiff_t a = 0; a < 4; ++a) {
        const std::ptrdiff_t i =
            (static_cast<std::ptrdiff_t>(x_floor) + a - 1 + domain.nx) % domain.nx;
        const std::ptrdiff_t row = i - slab.x_start;
        if (row < 0 || row >= slab.x_count) continue;
        for (std::ptrdiff_t b = 0; b < 4; ++b) {
            const std::ptrdiff_t j =
                (static_cast<std::ptrdiff_t>(y_floor) + b - 1 + domain.ny) % domain.ny;
            sum +=
                wx[static_cast<std::size_t>(a)] * wy[static_cast<std::size_t>(b)] * values(row, j);
        }
    }
    return sum;
}

PointSeries::PointSeries(const Case& c, const Comm& team, std::string name,
                         const std::vector<Vec2>& at_m)
    : Recording(c, team), name_(std::move(name)), series_(empty_series(at_m, c.time)) {}

void PointSeries::frame(const engines::Frame& frame) {
    if (frame.depth != 0) return;
    for (measures::TraceSeries& one : series_)
        one.u_m[static_cast<std::size_t>(frame.number)] =
            value_at(one.at_m, frame.u_z_m, case_.domain, slab_);
}

void PointSeries::save(StateWriter& state) {
    for (std::size_t i = 0; i < series_.size(); ++i)
        RankParts(team_).save(state, fmt::format("{}_{}", name_, i), series_[i].u_m);
}

void PointSeries::restore(const StateReader& state) {
    for (std::size_t i = 0; i < series_.size(); ++i)
        restore_sum(state, team_, fmt::format("{}_{}", name_, i), series_[i].u_m);
}

void PointSeries::finish() {
    for (measures::TraceSeries& one : series_)
        team_.sum(one.u_m);
}

void ReceptorSeries::record_at(const std::vector<Vec2>& at_m, std::vector<std::size_t> depths) {
    together(team_, [&] {
        depths_ = std::move(depths);
        series_ = empty_series(at_m, case_.time);
    });
}

void ReceptorSeries::stress(const engines::StressFrame& frame) {
    for (std::size_t i = 0; i < series_.size(); ++i)
        if (depths_[i] == frame.depth && case_.domain.contains(series_[i].at_m))
            series_[i].u_m[static_cast<std::size_t>(frame.number)] =
                value_at(series_[i].at_m, frame.compression_Pa, case_.domain, slab_);
}

void ReceptorSeries::save(StateWriter& state) {
    if (series_.empty()) return;
    std::vector<double> all;
    for (const measures::TraceSeries& receptor : series_)
        all.insert(all.end(), receptor.u_m.begin(), receptor.u_m.end());
    RankParts(team_).save(state, "stresses", all);
}

void ReceptorSeries::restore(const StateReader& state) {
    if (series_.empty()) return;
    std::vector<double> all(series_.size() * static_cast<std::size_t>(case_.time.frames));
    restore_sum(state, team_, "stresses", all);
    auto next = all.begin();
    for (measures::TraceSeries& receptor : series_) {
        const auto length = static_cast<std::ptrdiff_t>(receptor.u_m.size());
        std::copy_n(next, length, receptor.u_m.begin());
        next += length;
    }
}

void ReceptorSeries::finish() {
    for (measures::TraceSeries& receptor : series_)
        team_.sum(receptor.u_m);
}

namespace {

struct SpotSample {
    Vec2 offset_m;
    double weight = 1.0;
};

/// Radon's rule for a disc, exact for polynomials of degree 5.
std::vector<SpotSample> spot_samples(double diameter_m) {
    if (diameter_m == 0.0) return {{}};
    std::vector<SpotSample> samples = {{{}, 0.25}};
    const double radius_m = 0.5 * diameter_m * std::sqrt(2.0 / 3.0);
    for (int n = 0; n < 6; ++n) {
        const double angle = n * std::numbers::pi / 3.0;
        samples.push_back({radius_m * Vec2{std::cos(angle), std::sin(angle)}, 0.125});
    }
    return samples;
}

} // namespace

ScanSeries::ScanSeries(const Case& c, const Comm& team) : Recording(c, team) {
    if (c.vibrometer)
        displacements_m_.resize(c.vibrometer->points_m.size() *
                                static_cast<std::size_t>(c.time.frames));
}

void ScanSeries::add(std::ptrdiff_t number, double factor, View2<const double> values) {
    if (factor == 0.0) return;
    const std::vector<SpotSample> samples = spot_samples(case_.vibrometer->spot_m);
    const Vec2 offset = {case_.vibrometer->offset_x_m, case_.vibrometer->offset_y_m};
    std::size_t at = static_cast<std::size_t>(number);
    for (const Vec2 point : case_.vibrometer->points_m) {
        for (const SpotSample& sample : samples)
            displacements_m_[at] +=
                factor * sample.weight *
                value_at(point + offset + sample.offset_m, values, case_.domain, slab_);
        at += static_cast<std::size_t>(case_.time.frames);
    }
}

void ScanSeries::frame(const engines::Frame& frame) {
    if (case_.vibrometer && frame.depth == 0)
        add(frame.number, case_.vibrometer->line_of_sight().z, frame.u_z_m);
}

void ScanSeries::tangential(const engines::TangentialFrame& frame) {
    if (!case_.vibrometer) return;
    const Vec3 along = case_.vibrometer->line_of_sight();
    add(frame.number, frame.component == 0 ? along.x : along.y, frame.u_m);
}

void ScanSeries::save(StateWriter& state) {
    if (!displacements_m_.empty()) RankParts(team_).save(state, "scan", displacements_m_);
}

void ScanSeries::restore(const StateReader& state) {
    if (displacements_m_.empty()) return;
    std::fill(displacements_m_.begin(), displacements_m_.end(), 0.0);
    RankParts(team_).restore(
        state, "scan", displacements_m_.size(), [&](std::span<const double> part) {
            std::transform(displacements_m_.begin(), displacements_m_.end(), part.begin(),
                           displacements_m_.begin(), std::plus<>());
        });
}

void ScanSeries::finish() {
    if (!displacements_m_.empty()) team_.sum(displacements_m_);
}

} // namespace shearwake::pipeline
