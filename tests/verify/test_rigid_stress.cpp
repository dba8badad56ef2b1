// SPDX-License-Identifier: BSD-3-Clause
// The stress near a rigid sphere in engine "spectral" compared with the series of vector harmonics.
#include "support/sphere_scattering.hpp"

#include <catch2/catch.hpp>
#include <cstdio>

using namespace shearwake;
using test::Complex;
using test::dot;
using test::FreeSphere;
using test::RigidSphere;
using test::Scattering;

namespace {

/// A wave along the third axis of the series, polarised along the first one.
struct Wave {
    Vec3 polarisation, across, direction;
};
constexpr Wave waves[] = {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}},
                          {{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}}};

/// -sigma_zz of the scattered wave at a point outside, in units of mu per radius.
double exact_compression(const Scattering& series, const Wave& wave, double kappa, Vec3 r) {
    const auto axes = [&](Vec3 p) {
        return Vec3{dot(p, wave.polarisation), dot(p, wave.across), dot(p, wave.direction)};
    };
    const auto u_z = [&](Vec3 p) {
        const auto u = series.at(axes(p));
        return u[0].real() * wave.polarisation.z + u[1].real() * wave.across.z +
               u[2].real() * wave.direction.z;
    };
    constexpr double step = 1e-4; // error 1e-8
    const double slope =
        (u_z(r + Vec3{0.0, 0.0, step}) - u_z(r - Vec3{0.0, 0.0, step})) / (2.0 * step);
    return -kappa * kappa * series.potential(axes(r)).real() - 2.0 * slope;
}

} // namespace

TEST_CASE("stress around a rigid sphere", "[.][stress]") {
    const double kappa = GENERATE(1.0);
    const double per_radius = GENERATE(6.0, 9.0);
    const double width = GENERATE(8.0, 12.0);
    RigidSphere sphere(per_radius, kappa, width);
    for (const double excess : {test::fixed_sphere, 0.9}) {
        const Scattering series(Complex{0.0, kappa}, excess);
        const FreeSphere body(sphere, kappa, excess);
        for (const Wave& wave : waves) {
            const std::vector<double> forces = body.in_wave([&](Vec3 r) {
                return std::exp(-kappa * dot(r, wave.direction) / test::body_radius_m) *
                       wave.polarisation;
            });
            for (const double spacings : {0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0}) {
                const double r = 1.0 + spacings / per_radius;
                std::vector<Vec3> points;
                for (const Vec3& d : test::directions())
                    points.push_back((r * test::body_radius_m) * d);
                const std::vector<double> found = sphere.compression(forces, points);
                const std::vector<Vec3> u = sphere.field(forces, points);
                double above = 0.0, below = 0.0, largest = 0.0, worst = 0.0, above_u = 0.0, below_u = 0.0;
                double top = 0.0;
                for (std::size_t i = 0; i < points.size(); ++i) {
                    const Vec3 at = (1.0 / test::body_radius_m) * points[i];
                    const double exact = exact_compression(series, wave, kappa, at);
                    const double value = found[i] * test::body_radius_m / test::solid_mu_Pa;
                    const double error = value - exact;
                    above += error * error;
                    below += exact * exact;
                    largest = std::max(largest, std::abs(exact));
                    if (at.z < -0.99 * r) top = error;
                    worst = std::max(worst, std::abs(error));
                    const auto s = series.at({dot(at, wave.polarisation), dot(at, wave.across), dot(at, wave.direction)});
                    const Vec3 eu = s[0].real() * wave.polarisation + s[1].real() * wave.across + s[2].real() * wave.direction;
                    above_u += std::pow(norm(u[i] - eu), 2); below_u += std::pow(norm(eu), 2);
                }
                std::printf("per_radius %g width %g excess %g wave %d at %.1f spacings: rms %.4f worst/largest %.4f top/largest %.4f  u %.4f\n",
                            per_radius, width, excess, static_cast<int>(&wave - waves), spacings, std::sqrt(above / below),
                            worst / largest, top / largest, std::sqrt(above_u / below_u));
            }
        }
    }
}
