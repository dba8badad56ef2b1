// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "case/case.hpp"
#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/spectral/lateral/moving_load.hpp"

#include <cmath>
#include <complex>
#include <vector>

namespace shearwake::test {

/// Where a point lies: the element, its first level, and the place in it from -1 to 1.
struct DepthPlace {
    std::size_t element = 0;
    std::ptrdiff_t first = 0;
    double x = 0.0;
};
inline DepthPlace depth_place(const spectral::DepthMesh& mesh, double z_m) {
    std::size_t e = 0;
    while (mesh.ends_m[e + 1] < z_m)
        ++e;
    return {e, static_cast<std::ptrdiff_t>(e) * mesh.degree,
            2.0 * (z_m - mesh.ends_m[e]) / mesh.length_m(e) - 1.0};
}

/// Calls use(value, kx, ky, wave) for all wave vectors, from the pencils on this rank alone:
/// value(unknown) is a coefficient of the pencil and `wave` e^{i k.x} at a point, times two where
/// the conjugate wave vector is not stored.
template <class Use>
void each_wave(const Domain& domain, const spectral::DepthMesh& mesh,
               const spectral::WaveVectors& vectors, const Block* pencils, Vec3 at_m,
               const Use& use) {
    using spectral::parts;
    const auto levels = static_cast<std::ptrdiff_t>(mesh.levels()) - 1;
    for (std::ptrdiff_t row = 0; row < vectors.rows(); ++row) {
        if (vectors.is_nyquist(row)) continue;
        for (std::ptrdiff_t i = 0; 2 * i < domain.nx; ++i) {
            for (const int sign : {1, -1}) {
                if (sign < 0 && i == 0) continue;
                const std::ptrdiff_t lane = i % lane_count,
                                     pencil = row * vectors.blocks() + i / lane_count;
                const Block* u = pencils + pencil * 3 * levels * parts;
                const std::ptrdiff_t part = sign > 0 ? 0 : 2;
                const auto value = [&](std::ptrdiff_t unknown) {
                    return std::complex<double>(u[unknown * parts + part][lane],
                                                u[unknown * parts + part + 1][lane]);
                };
                const double kx = sign * vectors.kx_rad_m(i), ky = vectors.ky_rad_m(row);
                use(value, kx, ky,
                    (row > 0 ? 2.0 : 1.0) * std::polar(1.0, kx * (at_m.x - domain.x_m(0)) +
                                                                ky * (at_m.y - domain.y_m(0))));
            }
        }
    }
}

/// The displacement at a point by its definition: the sum over all wave vectors of
/// weight(kx, ky) u e^{i k.x} with u_x = i (c U - s V), u_y = i (s U + c V), u_z = W.
template <class Weight>
Vec3 displacement_at(const Domain& domain, const spectral::DepthMesh& mesh,
                     const spectral::WaveVectors& vectors, const Block* pencils, Vec3 at_m,
                     const Weight& weight) {
    const DepthPlace place = depth_place(mesh, at_m.z);
    const std::vector<double> weights = spectral::interpolation_weights(mesh.rule, place.x);
    const auto levels = static_cast<std::ptrdiff_t>(mesh.levels()) - 1;
    Vec3 sum{};
    each_wave(domain, mesh, vectors, pencils, at_m,
              [&](const auto& value, double kx, double ky, std::complex<double> wave) {
                  std::complex<double> radial, down, turning;
                  for (std::ptrdiff_t j = 0; j <= mesh.degree; ++j) {
                      const std::ptrdiff_t level = place.first + j;
                      if (level >= levels) continue;
                      const double of_node = weights[static_cast<std::size_t>(j)];
                      radial += of_node * value(2 * level);
                      down += of_node * value(2 * level + 1);
                      turning += of_node * value(2 * levels + level);
                  }
                  const double k = std::hypot(kx, ky);
                  const double cosine = k > 0.0 ? kx / k : 1.0, sine = k > 0.0 ? ky / k : 0.0;
                  const std::complex<double> imaginary(0.0, 1.0), weighted = weight(kx, ky) * wave;
                  sum =
                      sum + Vec3{(weighted * imaginary * (cosine * radial - sine * turning)).real(),
                                 (weighted * imaginary * (sine * radial + cosine * turning)).real(),
                                 (weighted * down).real()};
              });
    return sum;
}

/// The stress sigma_zz at a point of a solid at rest, evaluated as for receptors: lambda div u from
/// the smoothed polynomial of the element, 2 mu du_z/dz from its polynomial.
inline double vertical_stress_at(const Domain& domain, const spectral::DepthMesh& mesh,
                                 const spectral::WaveVectors& vectors, const Block* pencils,
                                 Vec3 at_m, double lambda_Pa, double mu_Pa) {
    const DepthPlace place = depth_place(mesh, at_m.z);
    const std::vector<double> smooth = spectral::smoothing_weights(mesh.rule, place.x),
                              here = spectral::interpolation_weights(mesh.rule, place.x);
    const auto levels = static_cast<std::ptrdiff_t>(mesh.levels()) - 1;
    const std::size_t nodes = here.size();
    std::vector<double> of_w(nodes, 0.0); // weights of W in the stress
    for (std::size_t q = 0; q < nodes; ++q)
        for (std::size_t j = 0; j < nodes; ++j)
            of_w[j] += 2.0 / mesh.length_m(place.element) * mesh.rule.derivative[q * nodes + j] *
                       (lambda_Pa * smooth[q] + 2.0 * mu_Pa * here[q]);
    double sum = 0.0;
    each_wave(domain, mesh, vectors, pencils, at_m,
              [&](const auto& value, double kx, double ky, std::complex<double> wave) {
                  std::complex<double> stress;
                  for (std::size_t j = 0; j < nodes; ++j) {
                      const std::ptrdiff_t level = place.first + static_cast<std::ptrdiff_t>(j);
                      if (level >= levels) continue;
                      stress += of_w[j] * value(2 * level + 1) -
                                lambda_Pa * smooth[j] * std::hypot(kx, ky) * value(2 * level);
                  }
                  sum += (wave * stress).real();
              });
    return sum;
}

} // namespace shearwake::test
