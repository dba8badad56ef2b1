// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/lateral_sponge.hpp"

#include "base/units.hpp"
#include "problem/case/edges.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake::spectral {
namespace {

constexpr std::ptrdiff_t displacements = 3;
constexpr std::ptrdiff_t planes_at_once =
    9; // number of planes that are exchanged between ranks at once

/// The minimum of viscosity over density within the uppermost `depth_m` [m^2/s].
double least_diffusivity_m2_s(const Medium& medium, double depth_m) {
    double least = 1e300, top_m = 0.0;
    for (const Layer& layer : medium.layers) {
        if (top_m >= depth_m) break;
        const auto* law = std::get_if<KelvinVoigt>(&layer.loss);
        least = std::min(least, law ? law->viscosity_Pa_s / layer.density_kg_m3 : 0.0);
        top_m += layer.thickness_m;
    }
    return least;
}

/// Impulses at intervals of T also emit waves of period T. Therefore T is limited to the time in
/// which waves cross a quarter of the sponge or the width of the focus, and to the value at which
/// waves of this period lose 87 % of their amplitude within the width of the sponge, omega^2 nu
/// W/(2 c^3) = 2. Without losses half of the focus width is sufficient: a sponge of 20 mm returns
/// 0.4 % of the energy of a pulse, as with shorter T, but 9 % with twice that T.
double interval_s(const Case& c, double speed_m_s) {
    const double width_m = c.domain.sponge_m;
    const double focus_s = fwhm_m(c.scene().load.footprint) / speed_m_s;
    const double nu = least_diffusivity_m2_s(c.scene().medium, width_m);
    const double dies_s = std::numbers::pi * std::sqrt(nu * width_m / std::pow(speed_m_s, 3));
    return std::min({0.25 * width_m / speed_m_s, focus_s, std::max(0.5 * focus_s, dies_s)});
}

} // namespace

SpongePlan sponge_plan(const Case& c, Lateral medium, double step_s) {
    const double width_m = c.domain.sponge_m;
    SpongePlan plan = {0, c.domain.nx, c.domain.ny};
    if (!(width_m > 0.0)) return plan;
    const double T = interval_s(c, edge_speed_m_s(c.scene().medium, width_m));
    plan.every = std::max<std::ptrdiff_t>(1, std::lround(std::floor(T / step_s + 1e-9)));
    if (medium == Lateral::varies) return plan;
    const double k_rad_m = bandwidth_rad_m(c.scene().load.footprint, 3e-2);
    const auto points = [&](double extent_m, std::ptrdiff_t all) {
        const double waves = std::ceil(k_rad_m * extent_m / two_pi);
        if (2.0 * waves + 2.0 >= static_cast<double>(all)) return all;
        return std::min(all, good_even_length(2 * std::lround(waves) + 2));
    };
    plan.nx = points(c.domain.extent_x_m(), c.domain.nx);
    plan.ny = points(c.domain.extent_y_m(), c.domain.ny);
    return plan;
}

LateralSponge::LateralSponge(const Case& c, const WaveVectors& vectors,
                             const fft::SlabTransform& slabs, Lateral medium, double step_s,
                             const Comm& team)
    : kernels_(simd::kernels<SpongeKernels>()), vectors_(vectors), step_s_(step_s) {
    const auto [every, nx, ny] = sponge_plan(c, medium, step_s);
    every_ = every;
    if (every_ == 0) return;
    vectors_ = vectors.coarser(nx, ny);
    slabs_.emplace(nx, ny, team, slabs.planning());
    std::vector<fft::RowRun> all;
    for (std::ptrdiff_t i = 0; i < slabs_->share().x_count; ++i)
        all.push_back({i, 0, ny, static_cast<std::size_t>(i * ny)});
    runs_.emplace(*slabs_, team, std::move(all),
                  fft::RunTransform::Lines{vectors_.share().ky_start, vectors_.share().ky_count});
    const double width_m = c.domain.sponge_m, speed_m_s = edge_speed_m_s(c.scene().medium, width_m);
    const double time_s = static_cast<double>(every_) * step_s;
    const auto kept = [&](std::ptrdiff_t count, double extent_m) {
        std::vector<double> shares;
        for (std::ptrdiff_t i = 0; i < count; ++i) {
            const double place_m = static_cast<double>(i) * extent_m / static_cast<double>(count);
            const double from_edge_m = std::min(place_m, extent_m - place_m);
            shares.push_back(std::exp(-time_s * edge_drag_Hz(from_edge_m, width_m, speed_m_s)));
        }
        return shares;
    };
    kept_x_ = kept(nx, c.domain.extent_x_m());
    kept_y_ = kept(ny, c.domain.extent_y_m());
}

void LateralSponge::assemble(std::ptrdiff_t levels) {
    if (every_ == 0) return;
    count_ = displacements * levels;
    planes_.assign(static_cast<std::size_t>(count_ * runs_->lines_reals()), 0.0);
    values_.assign(
        static_cast<std::size_t>(planes_at_once * slabs_->share().x_count * vectors_.ny()), 0.0);
}

void LateralSponge::take_velocity(const VerticalOperator& op, std::ptrdiff_t blocks,
                                  const fft::AlignedVector<Block>& now,
                                  const fft::AlignedVector<Block>& before) {
    const std::ptrdiff_t size = op.unknowns() * parts, stride = runs_->lines_reals();
    const std::ptrdiff_t nx = vectors_.nx();
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        const bool is_nyquist = vectors_.is_nyquist(row);
        for (std::ptrdiff_t block = 0; acts_on(row, block); ++block) {
            const std::ptrdiff_t at = (row * blocks + block) * size;
            kernels_.put(vectors_.waves(row, block), op.levels(), now.data() + at,
                         before.data() + at, line(row), stride);
        }
        for (std::ptrdiff_t p = 0; p < count_; ++p) {
            double* modes = line(row) + p * stride;
            if (is_nyquist) {
                std::fill_n(modes, 2 * nx, 0.0);
                continue;
            }
            modes[nx] = modes[nx + 1] = 0.0; // kx = nx/2
            slabs_->line_to_physical(modes);
        }
    }
    const auto cells = static_cast<std::size_t>(slabs_->share().x_count * vectors_.ny());
    for (std::ptrdiff_t p = 0; p < count_; p += planes_at_once) {
        double* plane = planes_.data() + p * stride;
        const std::ptrdiff_t planes = std::min(planes_at_once, count_ - p);
        runs_->to_values(plane, planes, values_.data(), cells);
        lose(planes);
        runs_->to_lines(values_.data(), cells, planes, plane);
    }
}

void LateralSponge::lose(std::ptrdiff_t planes) {
    double* v = values_.data();
    for (std::ptrdiff_t p = 0; p < planes; ++p) {
        for (std::ptrdiff_t i = 0; i < slabs_->share().x_count; ++i) {
            const double kept_x = kept_x_[static_cast<std::size_t>(slabs_->share().x_start + i)];
            for (const double kept_y : kept_y_)
                *v++ *= 1.0 - kept_x * kept_y;
        }
    }
}

void LateralSponge::begin_row(std::ptrdiff_t row) {
    if (!acts_on(row, 0)) return;
    for (std::ptrdiff_t p = 0; p < count_; ++p)
        slabs_->line_to_spectral(line(row) + p * runs_->lines_reals());
}

void LateralSponge::impulse(const VerticalOperator& op, std::ptrdiff_t row, std::ptrdiff_t block,
                            Block* pencil) {
    const double points = static_cast<double>(vectors_.nx() * vectors_.ny());
    impulses_.resize(static_cast<std::size_t>(op.levels()));
    for (std::ptrdiff_t level = 0; level < op.levels(); ++level)
        impulses_[static_cast<std::size_t>(level)] =
            -0.5 * op.mass_kg_m2(level) / (points * step_s_ * step_s_);
    kernels_.take(vectors_.waves(row, block), op.levels(), impulses_.data(), line(row),
                  runs_->lines_reals(), pencil);
}

} // namespace shearwake::spectral
