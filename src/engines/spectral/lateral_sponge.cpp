#include "engines/spectral/lateral_sponge.hpp"

#include "engines/spectral/strain_transfer.hpp"
#include "model/edge_absorption.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake {
namespace {

constexpr std::ptrdiff_t components = 3;
constexpr std::ptrdiff_t together = 9; // planes that go from rank to rank at once

/// The least viscosity over density within the uppermost `depth_m` [m^2/s].
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

/// Impulses T apart also send out waves of period T. So T is no longer than waves take through a
/// quarter of the sponge or the width of the focus, nor than makes those lose 87 % of their
/// amplitude within the sponge's width, omega^2 nu W/(2 c^3) = 2. Without any loss half of the
/// focus' width is enough: of a pulse's energy 0.4 % comes back from 20 mm, as with shorter T, and
/// 9 % where T is twice that.
double interval_s(const Case& c, double speed_m_s) {
    const double width_m = c.domain.sponge_m;
    const double focus_s = fwhm_m(c.load.footprint) / speed_m_s;
    const double nu = least_diffusivity_m2_s(c.medium, width_m);
    const double dies_s = std::numbers::pi * std::sqrt(nu * width_m / std::pow(speed_m_s, 3));
    return std::min({0.25 * width_m / speed_m_s, focus_s, std::max(0.5 * focus_s, dies_s)});
}

/// i times the two halves of a value.
void times_i(const Lanes* a, Lanes* out) {
    out[plus_re] = -a[plus_im];
    out[plus_im] = a[plus_re];
    out[minus_re] = -a[minus_im];
    out[minus_im] = a[minus_re];
}

struct Direction {
    Lanes c[2], s; // for +kx and -kx
};
Direction direction(const WaveVectors& vectors, std::ptrdiff_t row, std::ptrdiff_t block) {
    const Lanes kx = vectors.kx(block), k = vectors.k(row, block);
    Direction at;
    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
        const bool moves = k[lane] > 0.0;
        at.c[0][lane] = moves ? kx[lane] / k[lane] : 1.0;
        at.c[1][lane] = moves ? -kx[lane] / k[lane] : 1.0;
        at.s[lane] = moves ? vectors.ky_rad_m(row) / k[lane] : 0.0;
    }
    return at;
}

} // namespace

SpongePlan sponge_plan(const Case& c, bool uniform, double step_s) {
    const double width_m = c.domain.sponge_m;
    SpongePlan plan = {0, c.domain.nx, c.domain.ny};
    if (!(width_m > 0.0)) return plan;
    const double T = interval_s(c, edge_speed_m_s(c.medium, width_m));
    plan.every = std::max<std::ptrdiff_t>(1, std::lround(std::floor(T / step_s + 1e-9)));
    if (!uniform) return plan;
    const double k_rad_m = bandwidth_rad_m(c.load.footprint, 3e-2);
    const auto points = [&](double extent_m, std::ptrdiff_t all) {
        const double waves = std::ceil(k_rad_m * extent_m / (2.0 * std::numbers::pi));
        if (2.0 * waves + 2.0 >= static_cast<double>(all)) return all;
        return std::min(all, good_even_length(2 * std::lround(waves) + 2));
    };
    plan.nx = points(c.domain.extent_x_m(), c.domain.nx);
    plan.ny = points(c.domain.extent_y_m(), c.domain.ny);
    return plan;
}

LateralSponge::LateralSponge(const Case& c, const WaveVectors& vectors, const SlabTransform& slabs,
                             bool uniform, double step_s, const Comm& team)
    : vectors_(vectors), step_s_(step_s) {
    const auto [every, nx, ny] = sponge_plan(c, uniform, step_s);
    every_ = every;
    if (every_ == 0) return;
    vectors_ = vectors.coarser(nx, ny);
    slabs_.emplace(nx, ny, team, slabs.planning());
    std::vector<RowRun> all;
    for (std::ptrdiff_t i = 0; i < slabs_->share().x_count; ++i)
        all.push_back({i, 0, ny, static_cast<std::size_t>(i * ny)});
    runs_.emplace(*slabs_, team, std::move(all),
                  RunTransform::Lines{vectors_.share().ky_start, vectors_.share().ky_count});
    const double width_m = c.domain.sponge_m, speed_m_s = edge_speed_m_s(c.medium, width_m);
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
    count_ = components * levels;
    planes_.assign(static_cast<std::size_t>(count_ * runs_->lines_reals()), 0.0);
    values_.assign(static_cast<std::size_t>(together * slabs_->share().x_count * vectors_.ny()),
                   0.0);
}

void LateralSponge::take_velocity(const VerticalOperator& op, std::ptrdiff_t blocks,
                                  const AlignedVector<double>& now,
                                  const AlignedVector<double>& before) {
    const std::ptrdiff_t size = op.unknowns() * parts, stride = runs_->lines_reals();
    const std::ptrdiff_t nx = vectors_.nx();
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        const bool is_nyquist = vectors_.is_nyquist(row);
        for (std::ptrdiff_t block = 0; acts_on(row, block); ++block) {
            const std::ptrdiff_t at = (row * blocks + block) * size;
            put(op, row, block, lanes(now.data()) + at, lanes(before.data()) + at);
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
    for (std::ptrdiff_t p = 0; p < count_; p += together) {
        double* plane = planes_.data() + p * stride;
        const std::ptrdiff_t planes = std::min(together, count_ - p);
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

/// u_x = i (c U - s V), u_y = i (s U + c V) and W.
void LateralSponge::put(const VerticalOperator& op, std::ptrdiff_t row, std::ptrdiff_t block,
                        const Lanes* now, const Lanes* before) {
    const Direction to = direction(vectors_, row, block);
    const std::ptrdiff_t stride = runs_->lines_reals();
    double* modes = line(row);
    for (std::ptrdiff_t level = 0; level < op.levels(); ++level) {
        const std::ptrdiff_t uw = 2 * level * parts, v = (op.psv() + level) * parts;
        Lanes x[parts], y[parts], w[parts], turned[parts];
        for (std::ptrdiff_t p = 0; p < parts; ++p) {
            const Lanes radial = now[uw + p] - before[uw + p];
            const Lanes across = now[v + p] - before[v + p];
            w[p] = now[uw + parts + p] - before[uw + parts + p];
            x[p] = to.c[p / 2] * radial - to.s * across;
            y[p] = to.s * radial + to.c[p / 2] * across;
        }
        times_i(x, turned);
        StrainTransfer::put(vectors_, block, modes, turned);
        times_i(y, turned);
        StrainTransfer::put(vectors_, block, modes + stride, turned);
        StrainTransfer::put(vectors_, block, modes + 2 * stride, w);
        modes += components * stride;
    }
}

void LateralSponge::begin_row(std::ptrdiff_t row) {
    if (!acts_on(row, 0)) return;
    for (std::ptrdiff_t p = 0; p < count_; ++p)
        slabs_->line_to_spectral(line(row) + p * runs_->lines_reals());
}

void LateralSponge::impulse(const VerticalOperator& op, std::ptrdiff_t row, std::ptrdiff_t block,
                            Lanes* pencil) {
    const Direction to = direction(vectors_, row, block);
    const std::ptrdiff_t stride = runs_->lines_reals();
    const double points = static_cast<double>(vectors_.nx() * vectors_.ny());
    const double* modes = line(row);
    for (std::ptrdiff_t level = 0; level < op.levels(); ++level) {
        const std::ptrdiff_t uw = 2 * level * parts, v = (op.psv() + level) * parts;
        const double scale = -0.5 * op.mass_kg_m2(level) / (points * step_s_ * step_s_);
        Lanes value[parts], x[parts], y[parts], w[parts];
        StrainTransfer::take(vectors_, block, modes, value);
        times_i(value, x); // times -i below: the inverse
        StrainTransfer::take(vectors_, block, modes + stride, value);
        times_i(value, y);
        StrainTransfer::take(vectors_, block, modes + 2 * stride, w);
        for (std::ptrdiff_t p = 0; p < parts; ++p) {
            pencil[uw + p] = -scale * (to.c[p / 2] * x[p] + to.s * y[p]);
            pencil[uw + parts + p] = scale * w[p];
            pencil[v + p] = -scale * (to.c[p / 2] * y[p] - to.s * x[p]);
        }
        modes += components * stride;
    }
}

} // namespace shearwake
