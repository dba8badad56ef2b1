#include "engines/spectral/lateral_sponge.hpp"

#include "engines/spectral/strain_transfer.hpp"
#include "model/edge_absorption.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake {
namespace {

constexpr std::ptrdiff_t components = 3;

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
/// amplitude within the sponge's width, omega^2 nu W/(2 c^3) = 2, unless the grid does not carry
/// them anyway, c T = 2 spacings.
double interval_s(const Case& c, double speed_m_s) {
    const double width_m = c.domain.sponge_m;
    const double nu = least_diffusivity_m2_s(c.medium, width_m);
    const double dies_s = std::numbers::pi * std::sqrt(nu * width_m / std::pow(speed_m_s, 3));
    return std::min({0.25 * width_m / speed_m_s, fwhm_m(c.load.footprint) / speed_m_s,
                     std::max(2.0 * c.domain.spacing_m / speed_m_s, dies_s)});
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

LateralSponge::LateralSponge(const Case& c, const WaveVectors& vectors, const SlabTransform& slabs,
                             double step_s, const Comm& team)
    : slabs_(slabs), vectors_(vectors), domain_(c.domain), step_s_(step_s) {
    const double width_m = c.domain.sponge_m;
    if (!(width_m > 0.0)) return;
    std::vector<RowRun> all;
    for (std::ptrdiff_t i = 0; i < slabs.share().x_count; ++i)
        all.push_back({i, 0, c.domain.ny, static_cast<std::size_t>(i * c.domain.ny)});
    runs_.emplace(slabs, team, std::move(all));
    const double speed_m_s = edge_speed_m_s(c.medium, width_m);
    const double steps = std::floor(interval_s(c, speed_m_s) / step_s + 1e-9);
    every_ = std::max<std::ptrdiff_t>(1, std::lround(steps));
    const double time_s = static_cast<double>(every_) * step_s;
    const auto kept = [&](double x_m, double extent_m) {
        const double from_edge_m = 0.5 * extent_m - std::abs(x_m);
        return std::exp(-time_s * edge_drag_Hz(from_edge_m, width_m, speed_m_s));
    };
    for (std::ptrdiff_t i = 0; i < c.domain.nx; ++i)
        kept_x_.push_back(kept(c.domain.x_m(i), c.domain.extent_x_m()));
    for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j)
        kept_y_.push_back(kept(c.domain.y_m(j), c.domain.extent_y_m()));
}

void LateralSponge::assemble(std::ptrdiff_t levels) {
    if (every_ == 0) return;
    count_ = components * levels;
    planes_.assign(static_cast<std::size_t>(count_ * slabs_.lines_reals()), 0.0);
    const std::ptrdiff_t rows = slabs_.share().x_count;
    values_.assign(static_cast<std::size_t>(rows * domain_.ny), 0.0);
}

void LateralSponge::take_velocity(const VerticalOperator& op, const AlignedVector<double>& now,
                                  const AlignedVector<double>& before) {
    const std::ptrdiff_t size = op.unknowns() * parts, stride = slabs_.lines_reals();
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        const bool is_nyquist = vectors_.is_nyquist(row);
        for (std::ptrdiff_t block = 0; block < vectors_.blocks() && !is_nyquist; ++block) {
            const std::ptrdiff_t at = (row * vectors_.blocks() + block) * size;
            put(op, row, block, lanes(now.data()) + at, lanes(before.data()) + at);
        }
        for (std::ptrdiff_t p = 0; p < count_; ++p) {
            double* modes = line(row) + p * stride;
            if (is_nyquist) {
                std::fill_n(modes, 2 * domain_.nx, 0.0);
                continue;
            }
            modes[domain_.nx] = modes[domain_.nx + 1] = 0.0; // kx = nx/2
            slabs_.line_to_physical(modes);
        }
    }
    for (std::ptrdiff_t p = 0; p < count_; ++p) {
        double* plane = planes_.data() + p * stride;
        runs_->to_values(plane, 1, values_.data(), values_.size());
        double* v = values_.data();
        for (std::ptrdiff_t i = 0; i < slabs_.share().x_count; ++i) {
            const double kept_x = kept_x_[static_cast<std::size_t>(slabs_.share().x_start + i)];
            for (const double kept_y : kept_y_)
                *v++ *= 1.0 - kept_x * kept_y;
        }
        runs_->to_lines(values_.data(), values_.size(), 1, plane);
    }
}

/// u_x = i (c U - s V), u_y = i (s U + c V) and W.
void LateralSponge::put(const VerticalOperator& op, std::ptrdiff_t row, std::ptrdiff_t block,
                        const Lanes* now, const Lanes* before) {
    const Direction to = direction(vectors_, row, block);
    const std::ptrdiff_t stride = slabs_.lines_reals();
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
    for (std::ptrdiff_t p = 0; p < count_; ++p)
        slabs_.line_to_spectral(line(row) + p * slabs_.lines_reals());
}

void LateralSponge::impulse(const VerticalOperator& op, std::ptrdiff_t row, std::ptrdiff_t block,
                            Lanes* pencil) {
    const Direction to = direction(vectors_, row, block);
    const std::ptrdiff_t stride = slabs_.lines_reals();
    const double points = static_cast<double>(domain_.nx * domain_.ny);
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
