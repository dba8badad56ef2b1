// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/observers/point_series.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>

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
    : case_(c), team_(team), name_(std::move(name)), series_(empty_series(at_m, c.time)) {}

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

void ReceptorSeries::keep(const std::vector<Vec2>& at_m, std::vector<std::size_t> depths) {
    together(team_, [&] {
        depths_ = std::move(depths);
        series_ = empty_series(at_m, case_.time);
    });
}

void ReceptorSeries::stress(const engines::StressFrame& frame) {
    for (std::size_t i = 0; i < series_.size(); ++i)
        if (depths_[i] == frame.depth && case_.domain.holds(series_[i].at_m))
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

} // namespace shearwake::pipeline
