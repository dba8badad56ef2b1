// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/stress/section_forces.hpp"

#include "base/constants.hpp"
#include "engines/spectral/bodies/section_markers.hpp"

#include <cmath>
#include <numbers>

namespace shearwake::spectral {
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
