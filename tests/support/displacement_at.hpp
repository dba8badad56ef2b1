// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "case/case.hpp"
#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/spectral/lateral/moving_load.hpp"

#include <cmath>
#include <complex>
#include <vector>

namespace shearwake::test {

/// Calls use(sign, i, row, value) for all wave vectors of this rank, with the values of the unknowns
/// of a pencil: value(unknown).
template <class Use>
void each_wave(const Domain& domain, const spectral::DepthMesh& mesh,
               const spectral::WaveVectors& vectors, const Block* pencils, const Use& use) {
    using spectral::parts;
    const auto levels = static_cast<std::ptrdiff_t>(mesh.levels()) - 1;
    for (std::ptrdiff_t row = 0; row < vectors.rows(); ++row) {
        if (vectors.is_nyquist(row)) continue;
        for (std::ptrdiff_t i = 0; 2 * i < domain.nx; ++i)
            for (const int sign : {1, -1}) {
                if (sign < 0 && i == 0) continue;
                const Block* u =
                    pencils + (row * vectors.blocks() + i / lane_count) * 3 * levels * parts;
                const std::ptrdiff_t part = sign > 0 ? 0 : 2;
                use(sign, i, row, [&](std::ptrdiff_t unknown) {
                    return std::complex<double>(u[unknown * parts + part][i % lane_count],
                                                u[unknown * parts + part + 1][i % lane_count]);
                });
            }
    }
}

/// The displacement at a point from the pencils of all wave vectors on this rank alone, by its
/// definition: the sum over all wave vectors of weight(kx, ky) u e^{i k.x} with u_x = i (c U - s
/// V), u_y = i (s U + c V), u_z = W.
template <class Weight>
Vec3 displacement_at(const Domain& domain, const spectral::DepthMesh& mesh,
                     const spectral::WaveVectors& vectors, const Block* pencils, Vec3 at_m,
                     const Weight& weight) {
    using spectral::parts;
    std::size_t e = 0;
    while (mesh.ends_m[e + 1] < at_m.z)
        ++e;
    const auto weights = spectral::interpolation_weights(
        mesh.rule, 2.0 * (at_m.z - mesh.ends_m[e]) / mesh.length_m(e) - 1.0);
    const auto levels = static_cast<std::ptrdiff_t>(mesh.levels()) - 1;
    Vec3 sum{};
    each_wave(domain, mesh, vectors, pencils,
              [&](int sign, std::ptrdiff_t i, std::ptrdiff_t row, const auto& value) {
                  std::complex<double> radial, down, turning;
                  for (std::ptrdiff_t j = 0; j <= mesh.degree; ++j) {
                      const std::ptrdiff_t level = static_cast<std::ptrdiff_t>(e) * mesh.degree + j;
                      if (level >= levels) continue;
                      const double of_node = weights[static_cast<std::size_t>(j)];
                      radial += of_node * value(2 * level);
                      down += of_node * value(2 * level + 1);
                      turning += of_node * value(2 * levels + level);
                  }
                  const double kx = sign * vectors.kx_rad_m(i), ky = vectors.ky_rad_m(row);
                  const double k = std::hypot(kx, ky);
                  const double cosine = k > 0.0 ? kx / k : 1.0, sine = k > 0.0 ? ky / k : 0.0;
                  // The conjugate wave vectors of ky > 0 are not stored.
                  const std::complex<double> wave =
                      (row > 0 ? 2.0 : 1.0) * weight(kx, ky) *
                      std::polar(1.0,
                                 kx * (at_m.x - domain.x_m(0)) + ky * (at_m.y - domain.y_m(0)));
                  const std::complex<double> imaginary(0.0, 1.0);
                  sum = sum + Vec3{(wave * imaginary * (cosine * radial - sine * turning)).real(),
                                   (wave * imaginary * (sine * radial + cosine * turning)).real(),
                                   (wave * down).real()};
              });
    return sum;
}

/// -sigma_zz [Pa] at a point of a homogeneous solid: minus lambda (W' - k U) + 2 mu W'.
inline double compression_at(const Domain& domain, const spectral::DepthMesh& mesh,
                             const spectral::WaveVectors& vectors, const Block* pencils, Vec3 at_m,
                             double lambda_Pa, double mu_Pa) {
    std::size_t e = 0;
    while (mesh.ends_m[e + 1] < at_m.z)
        ++e;
    const std::size_t nodes = mesh.rule.nodes.size();
    const double x = 2.0 * (at_m.z - mesh.ends_m[e]) / mesh.length_m(e) - 1.0;
    // The pressure as at receptors.
    const auto weights = spectral::smoothing_weights(mesh.rule, x),
               point = spectral::interpolation_weights(mesh.rule, x);
    std::vector<double> slopes(nodes, 0.0), smooth_slopes(nodes, 0.0);
    for (std::size_t q = 0; q < nodes; ++q)
        for (std::size_t j = 0; j < nodes; ++j) {
            const double d = mesh.rule.derivative[q * nodes + j] * 2.0 / mesh.length_m(e);
            slopes[j] += point[q] * d;
            smooth_slopes[j] += weights[q] * d;
        }
    const auto levels = static_cast<std::ptrdiff_t>(mesh.levels()) - 1;
    double sum = 0.0;
    each_wave(domain, mesh, vectors, pencils,
              [&](int sign, std::ptrdiff_t i, std::ptrdiff_t row, const auto& value) {
                  const double kx = sign * vectors.kx_rad_m(i), ky = vectors.ky_rad_m(row);
                  std::complex<double> radial, slope, smooth_slope;
                  for (std::size_t j = 0; j < nodes; ++j) {
                      const auto level =
                          static_cast<std::ptrdiff_t>(e) * mesh.degree + static_cast<int>(j);
                      if (level >= levels) continue;
                      radial += weights[j] * value(2 * level);
                      slope += slopes[j] * value(2 * level + 1);
                      smooth_slope += smooth_slopes[j] * value(2 * level + 1);
                  }
                  const std::complex<double> stress =
                      lambda_Pa * (smooth_slope - std::hypot(kx, ky) * radial) + 2.0 * mu_Pa * slope;
                  sum -= (row > 0 ? 2.0 : 1.0) *
                         (stress * std::polar(1.0, kx * (at_m.x - domain.x_m(0)) +
                                                       ky * (at_m.y - domain.y_m(0))))
                             .real();
              });
    return sum;
}

} // namespace shearwake::test
