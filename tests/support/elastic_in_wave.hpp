// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/rigid_cylinder.hpp"
#include "support/sphere_in_wave.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>

// Elastic cylinders and spheres of radius 1 in plane shear waves, in an incompressible solid of
// modulus 1 and density 1 at exponential growth: e^{kappa x}, and inside the body the wavenumber
// kappa sqrt(density/modulus). What a wave scatters to a direction is stated as the work of the
// forces that the body adds to the solid, with a negative sign, on a plane wave of that direction.
namespace shearwake::test {

struct Contrast {
    double modulus = 1.0, density = 1.0;
};

/// I_n or K_n of a multiple of the radius at radius 1, with two derivatives over the radius.
struct Radial {
    double value, slope, bend;

    static Radial of(double value, double slope, int n, double k) {
        return {value, slope, (k * k + n * n) * value - slope};
    }
    static Radial i(int n, double k) {
        return of(bessel_i(n, k), 0.5 * k * (bessel_i(std::abs(n - 1), k) + bessel_i(n + 1, k)), n,
                  k);
    }
    static Radial k(int n, double k) {
        return of(bessel_k(n, k), -0.5 * k * (bessel_k(std::abs(n - 1), k) + bessel_k(n + 1, k)), n,
                  k);
    }
};

constexpr int cylinder_orders = 12; // (kappa/2)^24/12!^2 remains

/// Cylinder and a wave e^{kappa x} polarised along its axis; `angle` is that between both
/// directions. The wave is the sum of e_n I_n(kappa r) cos(n theta), e_n = 2 - [n = 0], and
/// scattered to e_n t_n K_n cos(n theta); displacement and traction are continuous.
inline double along_cylinder(double kappa, Contrast body, double angle) {
    double sum = 0.0;
    for (int n = 0; n < cylinder_orders; ++n) {
        const Radial i = Radial::i(n, kappa), k = Radial::k(n, kappa),
                     in = Radial::i(n, kappa * std::sqrt(body.density / body.modulus));
        const double t = -(i.slope * in.value - body.modulus * in.slope * i.value) /
                         (k.slope * in.value - body.modulus * in.slope * k.value);
        sum += (n > 0 ? 2.0 : 1.0) * t * std::cos(n * angle);
    }
    return -2.0 * std::numbers::pi * sum;
}

/// Displacement and traction at radius 1: radial part (times sin n theta) and part along theta
/// (times cos n theta).
using Surface = Eigen::Vector4d;
/// Of the motion curl of f(r) cos(n theta).
inline Surface of_shear(const Radial& f, int n, double modulus) {
    const double r = -n * f.value, t = -f.slope;
    return {r, t, modulus * 2.0 * (-n * (f.slope - f.value)), modulus * (n * r - f.bend - t)};
}
/// Of the motion grad of r^m sin(n theta), m = n or -n.
inline Surface of_pressure(int m, int n, const Contrast& c, double kappa) {
    const double r = m, t = n;
    return {r, t, c.density * kappa * kappa + c.modulus * 2.0 * m * (m - 1.0),
            c.modulus * (n * r + n * (m - 1.0) - t)};
}

/// The same as along_cylinder() for a wave polarised across the axis, the curl of e^{kappa x}, and
/// is scattered to the curl of a_n K_n cos(n theta) and the gradient of c_n r^{-n} sin(n theta).
inline double across_cylinder(double kappa, Contrast body, double angle) {
    double sum = 0.0;
    const double inside = kappa * std::sqrt(body.density / body.modulus);
    for (int n = 0; n < cylinder_orders; ++n) {
        const Surface wave = of_shear(Radial::i(n, kappa), n, 1.0);
        Eigen::Matrix4d all;
        all << of_shear(Radial::k(n, kappa), n, 1.0), of_pressure(-n, n, {}, kappa),
            -of_shear(Radial::i(n, inside), n, body.modulus), -of_pressure(n, n, body, kappa);
        double a = 0.0;
        if (n > 0) {
            a = -all.fullPivLu().solve(wave)[0];
        } else { // no motion along r
            Eigen::Matrix2d turning;
            turning << all(1, 0), all(1, 2), all(3, 0), all(3, 2);
            a = -turning.fullPivLu().solve(Eigen::Vector2d(wave[1], wave[3]))[0];
        }
        sum += (n > 0 ? 2.0 : 1.0) * a * std::cos(n * angle);
    }
    return 2.0 * std::numbers::pi * kappa * kappa * sum;
}

/// Sphere and the wave e_x e^{-kappa z}, in the vector harmonics of Scattering; inside of it are
/// f_n M_n, g_n N_n and d_n grad(r^n P_n^1(cos theta) cos phi).
class ElasticSphere {
public:
    ElasticSphere(double kappa, Contrast body) : k_(imaginary * kappa) {
        const Complex inside = k_ * std::sqrt(body.density / body.modulus);
        const Spherical out(k_), in(inside);
        using Four = Eigen::Vector4cd;
        for (std::size_t n = 1; n < most; ++n) {
            const auto m = static_cast<double>(n);
            // z_n and (k r) z_n at radius 1 with derivatives over k r.
            const auto shear = [&](const auto& z, Complex k, double modulus) {
                const Complex s = k * z[n], ds = k * Spherical::slope(z, n, k),
                              dds = (m * (m + 1.0) / (k * k) - 1.0) * s;
                const Complex r = m * (m + 1.0) * s / (k * k), t = ds / k,
                              dr = k * m * (m + 1.0) * (ds / (k * k) - 2.0 * s / (k * k * k)),
                              dt = k * (dds / k - ds / (k * k));
                return Four{r, t, 2.0 * modulus * dr, modulus * (dt - t + r)};
            };
            const auto pressure = [&](double power, const Contrast& c) {
                return Four{power, 1.0,
                            -c.density * k_ * k_ + 2.0 * c.modulus * power * (power - 1.0),
                            c.modulus * ((power - 1.0) - 1.0 + power)};
            };
            Eigen::Matrix4cd all;
            all << shear(out.h, k_, 1.0), pressure(-m - 1.0, {}),
                -shear(in.j, inside, body.modulus), -pressure(m, body);
            b_[n] = all.fullPivLu().solve(imaginary * shear(out.j, k_, 1.0))[0];
            // M_n: z_n across, and its traction z_n' - z_n.
            const auto turning = [&](const auto& z, Complex k, double modulus) {
                const Complex dz = k * (Spherical::slope(z, n, k) - z[n] / k);
                return std::array<Complex, 2>{z[n], modulus * (dz - z[n])};
            };
            const auto wave = turning(out.j, k_, 1.0), h = turning(out.h, k_, 1.0),
                       f = turning(in.j, inside, body.modulus);
            a_[n] = -(wave[1] * f[0] - wave[0] * f[1]) / (h[1] * f[0] - h[0] * f[1]);
        }
    }
    /// For the wave p e^{kappa r.d}, where p is across d.
    double scattered(Vec3 direction, Vec3 polarisation) const {
        const double cosine = direction.z, sine = std::hypot(direction.x, direction.y);
        const double cos_phi = sine > 0.0 ? direction.x / sine : 1.0,
                     sin_phi = sine > 0.0 ? direction.y / sine : 0.0;
        double before = 0.0, pi_n = 1.0;
        Complex polar = 0.0, around = 0.0;
        for (std::size_t n = 1; n < most; ++n) {
            const auto m = static_cast<double>(n);
            const double tau = m * cosine * pi_n - (m + 1.0) * before;
            const Complex e = std::pow(imaginary, static_cast<int>(n)) * (2.0 * m + 1.0) /
                              (m * (m + 1.0)) * std::pow(-imaginary, static_cast<int>(n) + 1);
            polar += e * cos_phi * (a_[n] * pi_n + imaginary * b_[n] * tau);
            around -= e * sin_phi * (a_[n] * tau + imaginary * b_[n] * pi_n);
            const double next = ((2.0 * m + 1.0) * cosine * pi_n - (m + 1.0) * before) / m;
            before = pi_n;
            pi_n = next;
        }
        const Vec3 to_pole{cosine * cos_phi, cosine * sin_phi, -sine},
            about{-sin_phi, cos_phi, 0.0};
        return (-4.0 * std::numbers::pi / k_ *
                (polar * dot(polarisation, to_pole) + around * dot(polarisation, about)))
            .real();
    }

private:
    Complex k_;
    std::array<Complex, most> a_{}, b_{};
};

} // namespace shearwake::test
