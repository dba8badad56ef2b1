// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/rigid_sphere.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

// A rigid sphere of radius 1, fixed or free, in a plane shear wave.
namespace shearwake::test {

using Complex = std::complex<double>;
using Vector = std::array<Complex, 3>;
constexpr Complex imaginary{0.0, 1.0};
constexpr int most = 12; // order of the harmonics

/// Spherical Bessel functions j_n and Hankel functions h_n of the first kind, n = 0 ... most.
struct Spherical {
    std::array<Complex, most + 1> j, h;

    explicit Spherical(Complex x) {
        for (int n = 0; n <= most; ++n) { // power series; |x| < 5
            Complex term = 1.0;
            for (int i = 1; i <= n; ++i)
                term *= x / (2.0 * i + 1.0);
            Complex sum = term;
            for (int i = 1; i < 40; ++i) {
                term *= -0.5 * x * x / (i * (2.0 * n + 2.0 * i + 1.0));
                sum += term;
            }
            j[static_cast<std::size_t>(n)] = sum;
        }
        h[0] = -imaginary * std::exp(imaginary * x) / x;
        h[1] = -std::exp(imaginary * x) * (x + imaginary) / (x * x);
        for (std::size_t n = 1; n < most; ++n)
            h[n + 1] = (2.0 * static_cast<double>(n) + 1.0) / x * h[n] - h[n - 1];
    }
    /// (x z_n)'/x of j or h.
    static Complex slope(const std::array<Complex, most + 1>& z, std::size_t n, Complex x) {
        return z[n - 1] - static_cast<double>(n) * z[n] / x;
    }
};

/// The shear wave e_x e^{ikz} around a rigid sphere of radius 1 in an incompressible solid, with
/// the time factor e^{-i omega t}, k = omega/c_s, Im k >= 0. At growth e^{st}, k = i s/c_s.
///
/// With the vector harmonics of Bohren and Huffman (Absorption and Scattering of Light by Small
/// Particles, 1983, section 4.2) the wave is the sum over n of E_n (M_n - i N_n) of the first
/// kind, E_n = i^n (2n + 1)/(n(n + 1)). The scattered wave is the sum of
/// E_n (a_n M_n + b_n N_n + c_n L_n) with M_n and N_n of the third kind and
/// L_n = grad(r^{-n-1} P_n^1(cos theta) cos phi), the motion due to the pressure. The coefficients
/// follow from the displacement of the sphere, a translation U along x and a rotation about y:
///     j_n + a_n h_n = 0,   i j_{n-1} - b_n h_{n-1} = 0,
/// apart from n = 1, where U and the rotation replace the zeros. They follow from the forces on
/// the sphere (Stokes; Mazur and Bedeaux).
class Scattering {
public:
    /// `excess` is the density of the sphere relative to the solid, less 1; infinite if it is
    /// fixed.
    Scattering(Complex k, double excess) : k_(k), at_surface_(k) {
        const Complex x = -imaginary * k;
        if (std::isfinite(excess)) {
            const Complex mass = 4.0 / 3.0 * std::numbers::pi * excess * x * x;
            // The wave is e^{-x z}.
            shift_ = force_in_wave(x) / (force_on_sphere(x) + mass);
            turn_ = -torque_in_wave(x) / (torque_on_sphere(x) + 0.4 * mass);
        }
        for (std::size_t n = 1; n < most; ++n) {
            const auto &j = at_surface_.j, &h = at_surface_.h;
            const Complex unit = n == 1 ? 1.0 / factor(1) : 0.0;
            a_[n] = (unit * turn_ - j[n]) / h[n];
            // Displacement along r: n (n + 1) (b h - i j)/k - (n + 1) c; across: slopes + c.
            // The first condition plus n + 1 times the second one contains b alone.
            b_[n] = (imaginary * j[n - 1] + 1.5 * unit * shift_) / h[n - 1];
            c_[n] = unit * shift_ + imaginary * Spherical::slope(j, n, k) -
                    b_[n] * Spherical::slope(h, n, k);
        }
    }

    Complex shift() const { return shift_; }
    Complex turn() const { return turn_; }
    /// Factors of the outgoing partial waves relative to the incoming ones.
    Complex outgoing_m(std::size_t n) const { return 1.0 + 2.0 * a_[n]; }
    Complex outgoing_n(std::size_t n) const { return 1.0 + 2.0 * imaginary * b_[n]; }

    /// The scattered displacement at a point outside.
    Vector at(Vec3 p) const {
        const double r = norm(p), cosine = p.z / r, sine = std::hypot(p.x, p.y) / r;
        const double cos_phi = sine > 0.0 ? p.x / (r * sine) : 1.0,
                     sin_phi = sine > 0.0 ? p.y / (r * sine) : 0.0;
        const Spherical z(k_ * r);
        double before = 0.0, pi_n = 1.0; // P_n^1/sin theta
        Complex radial = 0.0, polar = 0.0, around = 0.0;
        for (std::size_t n = 1; n < most; ++n) {
            const auto m = static_cast<double>(n);
            const double tau = m * cosine * pi_n - (m + 1.0) * before;
            const Complex slope = Spherical::slope(z.h, n, k_ * r);
            const double decay = std::pow(r, -m - 2.0);
            const Complex e = factor(n);
            radial += e * cos_phi * sine * pi_n *
                      (b_[n] * m * (m + 1.0) * z.h[n] / (k_ * r) - c_[n] * (m + 1.0) * decay);
            const Complex across = b_[n] * slope + c_[n] * decay;
            polar += e * cos_phi * (a_[n] * pi_n * z.h[n] + across * tau);
            around -= e * sin_phi * (a_[n] * tau * z.h[n] + across * pi_n);
            const double next = ((2.0 * m + 1.0) * cosine * pi_n - (m + 1.0) * before) / m;
            before = pi_n;
            pi_n = next;
        }
        const Complex level = radial * sine + polar * cosine;
        return {level * cos_phi - around * sin_phi, level * sin_phi + around * cos_phi,
                radial * cosine - polar * sine};
    }

    /// The pressure of the scattered wave at a point outside, in units of mu. It accelerates the
    /// motion of the coefficients c_n alone: k^2 L_n = grad p.
    Complex pressure(Vec3 p) const {
        const double r = norm(p), cosine = p.z / r;
        double before = 0.0, pi_n = 1.0;
        Complex sum = 0.0;
        for (std::size_t n = 1; n < most; ++n) {
            const auto m = static_cast<double>(n);
            sum += k_ * k_ * factor(n) * c_[n] * std::pow(r, -m - 2.0) * p.x * pi_n;
            const double next = ((2.0 * m + 1.0) * cosine * pi_n - (m + 1.0) * before) / m;
            before = pi_n;
            pi_n = next;
        }
        return sum;
    }

private:
    static Complex factor(std::size_t n) {
        const auto m = static_cast<double>(n);
        return std::pow(imaginary, static_cast<int>(n)) * (2.0 * m + 1.0) / (m * (m + 1.0));
    }

    Complex k_;
    Spherical at_surface_;
    Complex shift_ = 0.0, turn_ = 0.0;
    std::array<Complex, most> a_{}, b_{}, c_{};
};

inline double dot(Vec3 a, Vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

constexpr double fixed = std::numeric_limits<double>::infinity();

/// The forces of a sphere that is fixed or free in the waves that it meets.
class FreeSphere {
public:
    FreeSphere(const RigidSphere& sphere, double kappa, double excess)
        : sphere_(sphere), is_fixed_(!std::isfinite(excess)), stiffness_(6, 6) {
        if (is_fixed_) return;
        const double mass = 4.0 / 3.0 * std::numbers::pi * excess * kappa * kappa;
        for (std::size_t f = 0; f < 6; ++f) {
            motion_[f] = sphere.at_markers(
                [&](Vec3 r) { return spectral::motions_at((1.0 / body_radius_m) * r)[f]; });
            forces_[f] = sphere.forces(motion_[f]);
        }
        for (std::size_t f = 0; f < 6; ++f)
            for (std::size_t g = 0; g < 6; ++g)
                stiffness_(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(g)) =
                    RigidSphere::work(forces_[g], motion_[f]) + (f != g  ? 0.0
                                                                 : f < 3 ? mass
                                                                         : 0.4 * mass);
    }

    /// The forces on the solid that the sphere exerts in a wave.
    template <class Wave>
    std::vector<double> in_wave(const Wave& incident) const {
        std::vector<double> forces = sphere_.forces(sphere_.smoothed_at_markers(incident));
        for (double& force : forces)
            force = -force;
        if (is_fixed_) return forces;
        Eigen::VectorXd load(6);
        for (std::size_t f = 0; f < 6; ++f)
            load[static_cast<Eigen::Index>(f)] = -RigidSphere::work(forces, motion_[f]);
        const Eigen::VectorXd q = stiffness_.ldlt().solve(load);
        for (std::size_t f = 0; f < 6; ++f)
            for (std::size_t i = 0; i < forces.size(); ++i)
                forces[i] += q[static_cast<Eigen::Index>(f)] * forces_[f][i];
        return forces;
    }

private:
    const RigidSphere& sphere_;
    bool is_fixed_;
    Eigen::MatrixXd stiffness_; // the mass times s^2 and R' G^-1 R, in units of mu a
    std::array<std::vector<double>, 6> motion_, forces_; // R, and the forces for it
};

/// The axes of the series: a wave along the third one, polarised along the first one.
struct Wave {
    Vec3 polarisation, across, direction;

    Vec3 axes(Vec3 r) const { return {dot(r, polarisation), dot(r, across), dot(r, direction)}; }
    Vec3 real(const Vector& u) const {
        return u[0].real() * polarisation + u[1].real() * across + u[2].real() * direction;
    }
};
constexpr Wave waves[] = {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}},
                          {{0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}},
                          {{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}}};

} // namespace shearwake::test
