// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/grid_forces.hpp"

#include "engines/spectral/depth/vertical_operator.hpp"
#include "fft/aligned.hpp"

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
/// A depth within this distance of an element boundary, relative to the element's length, belongs
/// to both elements.
constexpr double rounding = 1e-9;

/// The elements around the forces and stresses, continued on both sides, and the depth of the
/// first end.
struct LongMesh {
    DepthMesh mesh;
    double top_m;
};

LongMesh long_mesh(const DepthMesh& mesh, double low_m, double high_m, double spacing_m) {
    LongMesh all{mesh, 0.0};
    std::vector<double> ends_m;
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        if (mesh.ends_m[e + 1] < low_m || mesh.ends_m[e] > high_m) continue;
        if (ends_m.empty()) ends_m.push_back(mesh.ends_m[e]);
        ends_m.push_back(mesh.ends_m[e + 1]);
    }
    const double outer_m = outer_spacings * spacing_m;
    for (int i = 0; i < outer_elements; ++i) {
        ends_m.insert(ends_m.begin(), ends_m.front() - outer_m);
        ends_m.push_back(ends_m.back() + outer_m);
    }
    all.top_m = ends_m.front();
    for (double& end_m : ends_m)
        end_m -= all.top_m;
    all.mesh.ends_m = ends_m;
    all.mesh.layers.assign(ends_m.size() - 1, 0);
    all.mesh.light.clear();
    all.mesh.bottom.reset();
    return all;
}

/// The static operator K of a solid with mu = 1 as the implicit operator of a step of 1 s, with its
/// weights.
VerticalOperator static_operator(const DepthMesh& mesh, double lambda_per_mu) {
    const std::size_t points = mesh.elements() * mesh.rule.nodes.size();
    const auto all = [&](double value) { return std::vector<double>(points, value); };
    return {mesh,
            {.density_kg_m3 = all(0.0),
             .lambda_Pa = all(lambda_per_mu / stabilising_lambda),
             .mu_accurate_Pa = all(12.0),
             .mu_stable_Pa = all(0.0),
             .viscosity_Pa_s = all(0.0),
             .mu_greatest_Pa = all(1.0),
             .swirl_viscosity_Pa_s = all(0.0),
             .force_lambda_Pa = all(lambda_per_mu),
             .theta_s = std::vector<double>(mesh.elements(), 0.0)}};
}

/// Node weights at a depth in an element: of the value, the slope, and both smoothed.
struct Place {
    std::ptrdiff_t first;
    double share; // of this element
    std::vector<double> value, slope, smooth, smooth_slope;
};

std::vector<double> slope_of(const std::vector<double>& weights, const DepthMesh& mesh,
                             double length_m) {
    const std::size_t nodes = weights.size();
    std::vector<double> slope(nodes, 0.0);
    for (std::size_t q = 0; q < nodes; ++q)
        for (std::size_t j = 0; j < nodes; ++j)
            slope[j] += 2.0 / length_m * weights[q] * mesh.rule.derivative[q * nodes + j];
    return slope;
}

std::vector<Place> places(const DepthMesh& mesh, double depth_m) {
    std::vector<Place> all;
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        const double length_m = mesh.length_m(e), margin_m = rounding * length_m;
        if (depth_m < mesh.ends_m[e] - margin_m || depth_m > mesh.ends_m[e + 1] + margin_m)
            continue;
        const double x = 2.0 * (depth_m - mesh.ends_m[e]) / length_m - 1.0;
        Place p{.first = static_cast<std::ptrdiff_t>(e) * mesh.degree,
                .share = 1.0,
                .value = interpolation_weights(mesh.rule, x),
                .slope = {},
                .smooth = smoothing_weights(mesh.rule, x),
                .smooth_slope = {}};
        p.slope = slope_of(p.value, mesh, length_m);
        p.smooth_slope = slope_of(p.smooth, mesh, length_m);
        all.push_back(std::move(p));
    }
    for (Place& p : all)
        p.share = 1.0 / static_cast<double>(all.size());
    return all;
}

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

/// Unit forces along and across the wave vector (part 0) and along z (part 1).
void put_forces(const Place& at, std::ptrdiff_t levels, fft::AlignedVector<Block>& pencil) {
    std::fill(pencil.begin(), pencil.end(), Block{});
    for (std::size_t j = 0; j < at.value.size(); ++j) {
        const std::ptrdiff_t level = at.first + static_cast<std::ptrdiff_t>(j);
        if (level >= levels) continue; // the last level does not move
        for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
            pencil[static_cast<std::size_t>(2 * level * parts)][lane] = at.value[j];
            pencil[static_cast<std::size_t>((2 * levels + level) * parts)][lane] = at.value[j];
            pencil[static_cast<std::size_t>((2 * level + 1) * parts + 1)][lane] = at.value[j];
        }
    }
}

/// The response of one lane to put_forces().
struct Lane {
    const Block* pencil;
    std::ptrdiff_t levels, lane;
    double k_rad_m, lambda_per_mu;

    /// The sum of weights times U or W (`unknown` 0 or 1) in a part, or times V (2).
    double sum(const Place& at, const std::vector<double>& weights, std::ptrdiff_t unknown,
               std::ptrdiff_t part) const {
        double sum = 0.0;
        for (std::size_t j = 0; j < weights.size(); ++j) {
            const std::ptrdiff_t level = at.first + static_cast<std::ptrdiff_t>(j);
            if (level >= levels) continue;
            const std::ptrdiff_t row = unknown < 2 ? 2 * level + unknown : 2 * levels + level;
            sum += weights[j] * pencil[row * parts + part][lane];
        }
        return sum;
    }
    RadialStress stress(const std::vector<Place>& places) const {
        RadialStress f{};
        for (const Place& at : places) {
            for (std::ptrdiff_t part = 0; part < 2; ++part) {
                const double pressure = lambda_per_mu * (sum(at, at.smooth_slope, 1, part) -
                                                         k_rad_m * sum(at, at.smooth, 0, part));
                auto& to = part == 0 ? f.along_r : f.along_z;
                to.rr += at.share * (pressure - 2.0 * k_rad_m * sum(at, at.value, 0, part));
                to.tt += at.share * pressure;
                to.zz += at.share * (pressure + 2.0 * sum(at, at.slope, 1, part));
                to.rz +=
                    at.share * (sum(at, at.slope, 0, part) + k_rad_m * sum(at, at.value, 1, part));
            }
            f.rt -= at.share * k_rad_m * sum(at, at.value, 2, 0);
            f.tz += at.share * sum(at, at.slope, 2, 0);
        }
        return f;
    }
};

/// The mean stress of the plane at a height below the force, of which half acts on either side.
RadialStress mean_stress(double below_m, double lambda_per_mu) {
    const double half = below_m > 0.0 ? -0.5 : below_m < 0.0 ? 0.5 : 0.0;
    const double across = half * lambda_per_mu / (lambda_per_mu + 2.0);
    return {.along_r = {0.0, 0.0, 0.0, half},
            .along_z = {across, across, half, 0.0},
            .rt = 0.0,
            .tz = half};
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
    const double reach_m = static_cast<double>(reach) * spacing_m;
    const auto [low, high] = std::minmax_element(force_m.begin(), force_m.end());
    const LongMesh all = long_mesh(mesh, *low - reach_m, *high + reach_m, spacing_m);
    const VerticalOperator op = static_operator(all.mesh, lambda_per_mu);
    std::vector<std::vector<Place>> stress_at, force_at;
    for (const double depth_m : stress_m)
        stress_at.push_back(places(all.mesh, depth_m - all.top_m));
    for (const double depth_m : force_m)
        force_at.push_back(places(all.mesh, depth_m - all.top_m));
    fft::AlignedVector<Block> factor(static_cast<std::size_t>(op.factor_size())),
        pencil(static_cast<std::size_t>(op.unknowns() * parts));
    const std::vector<WavePair> pairs = wave_pairs();
    for (std::size_t begin = 0; begin < pairs.size(); begin += lane_count) {
        const Block k = wavenumbers(pairs, begin, spacing_m);
        op.factorise_implicit(k, 1.0, factor.data());
        const std::size_t lanes = std::min<std::size_t>(lane_count, pairs.size() - begin);
        for (std::size_t d = 0; d < force_m.size(); ++d) {
            put_forces(force_at[d].front(), op.levels(), pencil);
            op.solve_implicit(factor.data(), pencil.data());
            for (std::size_t s = 0; s < stress_m.size(); ++s) {
                if (std::abs(stress_m[s] - force_m[d]) > reach_m) continue;
                for (std::size_t lane = 0; lane < lanes; ++lane) {
                    const auto [kx, ky] = pairs[begin + lane];
                    const Lane one{pencil.data(), op.levels(), static_cast<std::ptrdiff_t>(lane),
                                   k[static_cast<std::ptrdiff_t>(lane)], lambda_per_mu};
                    const RadialStress f =
                        kx == 0 ? mean_stress(stress_m[s] - force_m[d], lambda_per_mu)
                                : one.stress(stress_at[s]);
                    add(f, kx, ky, values(s, d));
                    if (kx != ky) add(f, ky, kx, values(s, d));
                }
            }
        }
    }
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

} // namespace shearwake::spectral
