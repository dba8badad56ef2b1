// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/observers/scan_series.hpp"

#include "pipeline/observers/point_series.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

namespace shearwake::pipeline {
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

ScanSeries::ScanSeries(const Case& c, const Comm& team) : case_(c), team_(team) {
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
