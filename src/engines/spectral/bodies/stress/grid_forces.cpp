// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/stress/grid_forces.hpp"

#include "base/units.hpp"
#include "engines/spectral/bodies/section_markers.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake::spectral {

namespace {

/// Wavenumbers up to that of the grid, along x and y: those of a periodic plane of 64 points. Its
/// images are seven times as far away as `reach`.
constexpr std::ptrdiff_t half_waves = 32;
/// Elements above and below, and their length in spacings. The next boundary is then as far away
/// as the images.
constexpr int outer_elements = 3;
constexpr double outer_spacings = 8.0;
/// Indices of kx >= ky, both at least 0.
using WavePair = std::array<std::ptrdiff_t, 2>;
std::vector<WavePair> wave_pairs() {
    std::vector<WavePair> pairs;
    for (std::ptrdiff_t kx = 0; kx < half_waves; ++kx)
        for (std::ptrdiff_t ky = 0; ky <= kx; ++ky)
            pairs.push_back({kx, ky});
    return pairs;
}

/// |k| [rad/m] of eight pairs; the last one is repeated.
Block wavenumbers(const std::vector<WavePair>& pairs, std::size_t begin, double spacing_m) {
    Block k{};
    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
        const auto [kx, ky] =
            pairs[std::min(begin + static_cast<std::size_t>(lane), pairs.size() - 1)];
        k[lane] = std::numbers::pi / (static_cast<double>(half_waves) * spacing_m) *
                  std::hypot(static_cast<double>(kx), static_cast<double>(ky));
    }
    return k;
}

} // namespace

Stress kelvin_stress(Vec3 r_m, double lambda_per_mu, Vec3 force_N) {
    const double nu = 0.5 * lambda_per_mu / (lambda_per_mu + 1.0);
    const double r = norm(r_m), scale = -1.0 / (8.0 * std::numbers::pi * (1.0 - nu) * r * r);
    const Vec3 n = (1.0 / r) * r_m, f = force_N;
    const double along = n.x * f.x + n.y * f.y + n.z * f.z;
    const double shear = scale * (1.0 - 2.0 * nu), all = 3.0 * scale * along;
    return {shear * (2.0 * f.x * n.x - along) + all * n.x * n.x,
            shear * (2.0 * f.y * n.y - along) + all * n.y * n.y,
            shear * (2.0 * f.z * n.z - along) + all * n.z * n.z,
            shear * (f.y * n.z + f.z * n.y) + all * n.y * n.z,
            shear * (f.x * n.z + f.z * n.x) + all * n.x * n.z,
            shear * (f.x * n.y + f.y * n.x) + all * n.x * n.y};
}

ForceStress kelvin_stress(Vec3 r_m, double lambda_per_mu) {
    return {kelvin_stress(r_m, lambda_per_mu, {1.0, 0.0, 0.0}),
            kelvin_stress(r_m, lambda_per_mu, {0.0, 1.0, 0.0}),
            kelvin_stress(r_m, lambda_per_mu, {0.0, 0.0, 1.0})};
}

GridForces::GridForces(const DepthMesh& mesh, double spacing_m, double lambda_per_mu,
                       const std::vector<double>& force_m, const std::vector<double>& stress_m)
    : forces_(force_m.size()), spacing_m_(spacing_m),
      values_(stress_m.size() * force_m.size() * per_pair, 0.0) {
    if (force_m.empty() || stress_m.empty()) return;
    for (std::ptrdiff_t k = 0; k < half_waves; ++k)
        for (std::ptrdiff_t i = 0; i < side; ++i) {
            const double angle =
                std::numbers::pi * static_cast<double>(k * i) / static_cast<double>(half_waves);
            cosine_.push_back(std::cos(angle));
            sine_.push_back(std::sin(angle));
        }
    StaticResponse response(mesh, lambda_per_mu, force_m, stress_m,
                            static_cast<double>(reach) * spacing_m,
                            std::vector<double>(outer_elements, outer_spacings * spacing_m));
    const std::vector<WavePair> pairs = wave_pairs();
    for (std::size_t begin = 0; begin < pairs.size(); begin += lane_count)
        response.each(
            wavenumbers(pairs, begin, spacing_m),
            static_cast<std::ptrdiff_t>(std::min<std::size_t>(lane_count, pairs.size() - begin)),
            [&](std::size_t s, std::size_t d, std::ptrdiff_t lane, const RadialStress& f) {
                const auto [kx, ky] = pairs[begin + static_cast<std::size_t>(lane)];
                add(f, kx, ky, values(s, d));
                if (kx != ky) add(f, ky, kx, values(s, d));
            });
}

void GridForces::add(const RadialStress& f, std::ptrdiff_t kx, std::ptrdiff_t ky,
                     double* values) const {
    const double k = std::hypot(static_cast<double>(kx), static_cast<double>(ky));
    const double c = k > 0.0 ? static_cast<double>(kx) / k : 1.0,
                 s = k > 0.0 ? static_cast<double>(ky) / k : 0.0;
    const double period_m = 2.0 * static_cast<double>(half_waves) * spacing_m_;
    const double scale = (kx > 0 ? 2.0 : 1.0) * (ky > 0 ? 2.0 : 1.0) / (period_m * period_m);
    const double* cos_x = cosine_.data() + kx * side;
    const double* sin_x = sine_.data() + kx * side;
    const double* cos_y = cosine_.data() + ky * side;
    const double* sin_y = sine_.data() + ky * side;
    // The sums over both signs of kx and ky; xx, yy, zz, yz, xz, xy.
    const struct {
        double amplitude;
        const double *x, *y;
    } terms[2 * strain_components] = {
        {c * (c * c * f.along_r.rr + s * s * f.along_r.tt + 2.0 * s * s * f.rt), sin_x, cos_y},
        {c * (s * s * f.along_r.rr + c * c * f.along_r.tt - 2.0 * s * s * f.rt), sin_x, cos_y},
        {c * f.along_r.zz, sin_x, cos_y},
        {-c * s * (f.along_r.rz - f.tz), sin_x, sin_y},
        {c * c * f.along_r.rz + s * s * f.tz, cos_x, cos_y},
        {s * (c * c * (f.along_r.rr - f.along_r.tt) - (c * c - s * s) * f.rt), cos_x, sin_y},
        {c * c * f.along_z.rr + s * s * f.along_z.tt, cos_x, cos_y},
        {s * s * f.along_z.rr + c * c * f.along_z.tt, cos_x, cos_y},
        {f.along_z.zz, cos_x, cos_y},
        {-s * f.along_z.rz, cos_x, sin_y},
        {-c * f.along_z.rz, sin_x, cos_y},
        {-c * s * (f.along_z.rr - f.along_z.tt), sin_x, sin_y},
    };
    for (const auto& term : terms)
        for (std::ptrdiff_t i = 0; i < side; ++i) {
            const double of_x = scale * term.amplitude * term.x[i];
            for (std::ptrdiff_t j = 0; j < side; ++j)
                *values++ += of_x * term.y[j];
        }
}

ForceStress GridForces::at(std::size_t stress_depth, std::size_t force_depth, std::ptrdiff_t x,
                           std::ptrdiff_t y) const {
    ForceStress all{};
    const std::ptrdiff_t i = std::abs(x), j = std::abs(y);
    if (i > reach || j > reach) return all;
    const double* pair = values_.data() + (stress_depth * forces_ + force_depth) * per_pair;
    const auto value = [&](std::size_t table, std::ptrdiff_t a, std::ptrdiff_t b) {
        return pair[table * static_cast<std::size_t>(side * side) +
                    static_cast<std::size_t>(a * side + b)];
    };
    const double sx = x < 0 ? -1.0 : 1.0, sy = y < 0 ? -1.0 : 1.0;
    // Odd in x or y as the number of their indices, that of the force included.
    all[0] = {sx * value(0, i, j),      sx * value(1, i, j), sx * value(2, i, j),
              sx * sy * value(3, i, j), value(4, i, j),      sy * value(5, i, j)};
    // The force along y is that along x with x and y exchanged.
    all[1] = {sy * value(1, j, i), sy * value(0, j, i),      sy * value(2, j, i),
              value(4, j, i),      sx * sy * value(3, j, i), sx * value(5, j, i)};
    all[2] = {value(6, i, j),      value(7, i, j),       value(8, i, j),
              sy * value(9, i, j), sx * value(10, i, j), sx * sy * value(11, i, j)};
    return all;
}

namespace {

/// Wavenumbers up to that of the grid: those of a period of 256 points. The images of a line of
/// forces at this distance change the stress at `reach` by less than 1 % of its value.
constexpr std::ptrdiff_t section_waves = 128;
/// The elements above and below, in spacings: the next boundary is as far away as the images.
constexpr double section_outer[] = {8.0, 16.0, 32.0, 64.0, 128.0};

double section_wave_rad_m(std::ptrdiff_t n, double spacing_m) {
    return std::numbers::pi * static_cast<double>(n) /
           (static_cast<double>(section_waves) * spacing_m);
}

} // namespace

Stress line_stress(Vec3 r_m, double lambda_per_mu, Vec3 force_N_m) {
    const double nu = 0.5 * lambda_per_mu / (lambda_per_mu + 1.0);
    const double r = std::hypot(r_m.x, r_m.z), x = r_m.x / r, z = r_m.z / r;
    const Vec3 f = force_N_m;
    const double radial = f.x * x + f.z * z;
    const double scale = -1.0 / (4.0 * std::numbers::pi * (1.0 - nu) * r);
    const double shear = scale * (1.0 - 2.0 * nu), all = 2.0 * scale * radial;
    const double out_of_plane = -f.y / (two_pi * r);
    const double s_xx = shear * (2.0 * f.x * x - radial) + all * x * x;
    const double s_zz = shear * (2.0 * f.z * z - radial) + all * z * z;
    return {s_xx,
            nu * (s_xx + s_zz),
            s_zz,
            out_of_plane * z,
            shear * (f.x * z + f.z * x) + all * x * z,
            out_of_plane * x};
}

SectionForces::SectionForces(const DepthMesh& mesh, double spacing_m, double lambda_per_mu,
                             const std::vector<double>& force_m,
                             const std::vector<double>& stress_m)
    : forces_(force_m.size()), spacing_m_(spacing_m),
      waves_(force_m.size() * stress_m.size() * section_waves) {
    const double period_m = 2.0 * static_cast<double>(section_waves) * spacing_m;
    for (std::ptrdiff_t n = 0; n < section_waves; ++n) {
        const double k_smoothing = section_wave_rad_m(n, spacing_m) * marker_smoothing * spacing_m;
        weights_.push_back((n > 0 ? 2.0 : 1.0) / period_m *
                           std::exp(-0.5 * k_smoothing * k_smoothing));
    }
    std::vector<double> lengths_m;
    for (const double length : section_outer)
        lengths_m.push_back(length * spacing_m);
    StaticResponse response(mesh, lambda_per_mu, force_m, stress_m, reach * spacing_m, lengths_m);
    for (std::ptrdiff_t begin = 0; begin < section_waves; begin += lane_count) {
        Block k{};
        for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
            k[lane] = section_wave_rad_m(begin + lane, spacing_m);
        response.each(
            k, lane_count,
            [&](std::size_t s, std::size_t d, std::ptrdiff_t lane, const RadialStress& stress) {
                waves_[(s * forces_ + d) * section_waves + static_cast<std::size_t>(begin + lane)] =
                    stress;
            });
    }
}

ForceStress SectionForces::at(std::size_t stress_depth, std::size_t force_depth,
                              double across_m) const {
    ForceStress all{};
    const RadialStress* waves =
        waves_.data() + (stress_depth * forces_ + force_depth) * section_waves;
    for (std::ptrdiff_t n = 0; n < section_waves; ++n) {
        const RadialStress& f = waves[n];
        const double k = section_wave_rad_m(n, spacing_m_);
        const double weight = weights_[static_cast<std::size_t>(n)];
        const double c = weight * std::cos(k * across_m), s = weight * std::sin(k * across_m);
        // The sums over both signs of k; xx, yy, zz, yz, xz, xy.
        const ForceStress one{Stress{s * f.along_r.rr, s * f.along_r.tt, s * f.along_r.zz, 0.0,
                                     c * f.along_r.rz, 0.0},
                              Stress{0.0, 0.0, 0.0, c * f.tz, 0.0, s * f.rt},
                              Stress{c * f.along_z.rr, c * f.along_z.tt, c * f.along_z.zz, 0.0,
                                     -s * f.along_z.rz, 0.0}};
        for (std::size_t force = 0; force < one.size(); ++force)
            for (std::size_t i = 0; i < strain_components; ++i)
                all[force][i] += one[force][i];
    }
    return all;
}

double SectionForces::memory_B(double forces, double stresses) {
    return sizeof(RadialStress) * static_cast<double>(section_waves) * forces * stresses;
}

} // namespace shearwake::spectral
