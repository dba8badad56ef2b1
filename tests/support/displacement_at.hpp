// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/spectral/lateral/moving_load.hpp"
#include "problem/case/case.hpp"

#include <cmath>
#include <complex>

namespace shearwake::test {

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
                    std::polar(1.0, kx * (at_m.x - domain.x_m(0)) + ky * (at_m.y - domain.y_m(0)));
                const std::complex<double> imaginary(0.0, 1.0);
                sum = sum + Vec3{(wave * imaginary * (cosine * radial - sine * turning)).real(),
                                 (wave * imaginary * (sine * radial + cosine * turning)).real(),
                                 (wave * down).real()};
            }
        }
    }
    return sum;
}

} // namespace shearwake::test
