// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/load_pattern.hpp"

#include "problem/load/acoustics/lens_design.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shearwake {
namespace {

using Complex = std::complex<double>;
/// Number of samples in the search for the largest distance of the focus.
constexpr int samples = 2000;

/// The times at which a focus that rests at one place after the other jumps.
std::vector<double> jumps_s(const Trajectory& trajectory) {
    std::vector<double> times_s;
    for (const Mover& part : trajectory.parts)
        if (const auto* travel = std::get_if<Travel>(&part))
            if (const auto* rests = std::get_if<Rests>(&travel->motion))
                times_s.insert(times_s.end(), rests->ends_s.begin(), rests->ends_s.end());
    return times_s;
}

double furthest_m(const Trajectory& trajectory, Vec2 from_m, double until_s) {
    std::vector<double> times_s = jumps_s(trajectory);
    for (int n = 0; n <= samples; ++n)
        times_s.push_back(until_s * n / samples);
    double furthest = 0.0;
    for (const double t_s : times_s) {
        const Vec2 off_m = position(trajectory, t_s) - from_m;
        furthest = std::max({furthest, std::abs(off_m.x), std::abs(off_m.y)});
    }
    // The largest additional distance between two samples.
    return furthest + greatest_speed_m_s(trajectory) * until_s / samples;
}

/// Simultaneous foci share the power.
Complex mean_phase(const std::vector<Vec2>& offsets_m, double kx_rad_m, double ky_rad_m) {
    if (offsets_m.empty()) return 1.0;
    Complex sum = 0.0;
    for (const Vec2& offset : offsets_m)
        sum += std::polar(1.0, -(kx_rad_m * offset.x + ky_rad_m * offset.y));
    return sum / static_cast<double>(offsets_m.size());
}

} // namespace

LoadPattern::LoadPattern(const Load& load, double until_s) : load_(load), until_s_(until_s) {
    const Trajectory& trajectory = load.modulation.trajectory;
    const auto steered = [&](ArrayFootprint array) {
        changes_ = greatest_speed_m_s(trajectory) > 0.0 || !jumps_s(trajectory).empty();
        double spread_m = 0.0;
        for (const Vec2& offset : load.modulation.foci_m)
            spread_m = std::max(spread_m, norm(offset));
        array.reach_m += spread_m;
        field_.emplace(array, furthest_m(trajectory, array.center_m, until_s));
    };
    std::visit(overloaded{[](const GaussianFootprint&) {}, steered,
                          [&](const LensFootprint& lens) { patch_ = design_of(lens)->pattern; }},
               load.footprint);
    set(0.0);
}

double LoadPattern::updated_s(double t_s) const {
    return shearwake::updated_s(load_, field_ ? std::min(t_s, until_s_) : t_s);
}

void LoadPattern::set(double updated_s) {
    set_focus(position(load_.modulation.trajectory, updated_s));
}

void LoadPattern::set_focus(Vec2 at_m) {
    if (!field_) {
        origin_m_ = at_m + patch_.origin_m;
        return;
    }
    if (!changes_ && patch_.side > 0) return;
    std::vector<Vec2> foci_m = load_.modulation.foci_m;
    if (foci_m.empty()) foci_m.emplace_back();
    for (Vec2& focus : foci_m)
        focus = at_m + focus;
    patch_ = field_->pattern(at_m, foci_m);
    origin_m_ = patch_.origin_m;
}

double LoadPattern::band_rad_m() const {
    return patch_.side > 0 ? patch_.band_rad_m() : std::numeric_limits<double>::infinity();
}

void LoadPattern::spectra(double ky_rad_m, std::span<const double> kx_rad_m,
                          std::span<Complex> out) const {
    if (patch_.side > 0) {
        const bool is_there = std::abs(ky_rad_m) <= band_rad_m();
        std::vector<Complex> columns(static_cast<std::size_t>(patch_.side));
        if (is_there) transform_columns(patch_, ky_rad_m, columns);
        for (std::size_t i = 0; i < kx_rad_m.size(); ++i)
            out[i] = is_there && std::abs(kx_rad_m[i]) <= band_rad_m()
                         ? transform_row(patch_, kx_rad_m[i], columns)
                         : 0.0;
        return;
    }
    for (std::size_t i = 0; i < kx_rad_m.size(); ++i) {
        out[i] = spectrum(load_.footprint, kx_rad_m[i], ky_rad_m) *
                 mean_phase(load_.modulation.foci_m, kx_rad_m[i], ky_rad_m);
    }
}

LoadPattern unsteered_pattern(const Load& load) {
    LoadPattern pattern(load, 0.0);
    if (!pattern.changes_) return pattern;
    const Vec2 centre_m = std::get<ArrayFootprint>(load.footprint).center_m;
    pattern.set_focus(centre_m);
    pattern.patch_.origin_m = pattern.patch_.origin_m - centre_m;
    pattern.changes_ = false;
    pattern.field_.reset();
    pattern.set(0.0);
    return pattern;
}

} // namespace shearwake
