// SPDX-License-Identifier: BSD-3-Clause
// Verification over a half-space: Lamb's problem and the steadily moving load.
#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <numbers>

namespace test_lamb {

using namespace shearwake;

constexpr double pi = std::numbers::pi;

static Layer poisson_solid() { // nu = 0.25
    Layer layer = test::tissue(5.0 * std::sqrt(3.0), 0.0);
    return layer;
}

/// Pekeris 1955: u_z(tau) = -g(tau) / (32 pi mu r) of a step point load of 1 N, nu = 0.25.
static double pekeris_g(double tau) {
    const double s3 = std::sqrt(3.0), gamma = 0.5 * std::sqrt(3.0 + s3), t2 = tau * tau;
    if (tau < 1.0 / s3) return 0.0;
    if (tau > gamma) return -12.0;
    const double pole = std::sqrt(3.0 * s3 + 5.0) / std::sqrt(gamma * gamma - t2);
    if (tau > 1.0) return -(12.0 - 2.0 * pole);
    return -(6.0 - s3 / std::sqrt(t2 - 0.25) - pole +
             std::sqrt(3.0 * s3 - 5.0) / std::sqrt(t2 + 0.25 * s3 - 0.75));
}

/// Integral of f over [a, b] by Gauss-Legendre (5 points) on `panels` panels.
static double integrate(double a, double b, int panels, const auto& f) {
    static constexpr double x[] = {-0.9061798459386640, -0.5384693101056831, 0.0,
                                   0.5384693101056831, 0.9061798459386640};
    static constexpr double w[] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                   0.4786286704993665, 0.2369268850561891};
    double sum = 0.0;
    const double h = (b - a) / panels;
    for (int p = 0; p < panels; ++p)
        for (int i = 0; i < 5; ++i)
            sum += 0.5 * h * w[i] * f(a + h * (p + 0.5 * (1.0 + x[i])));
    return sum;
}

/// The solution for a Gaussian of 1 Pa peak at distance r: the point solution at all distances rho,
/// weighted by the mean of the Gaussian over the circle of radius rho around the receiver,
///     2 pi exp(-(r^2 + rho^2) / 2 sigma^2) I0(r rho / sigma^2).
static double lamb_gaussian(double r, double t, double sigma, const Layer& layer) {
    const double mu = static_shear_modulus(layer), ct = layer.c_s_m_s * t;
    const double gamma = 0.5 * std::sqrt(3.0 + std::sqrt(3.0));
    // Gaussian times 2 pi rho, as a function of rho of the point solution.
    const auto ring = [&](double rho) {
        // exp(-x) I0(x), by the asymptotic series where I0 alone would overflow.
        const double x = r * rho / (sigma * sigma);
        const double bessel =
            x < 50.0 ? std::exp(-x) * std::cyl_bessel_i(0.0, x)
                     : (1.0 + 1.0 / (8.0 * x) + 9.0 / (128.0 * x * x)) / std::sqrt(2.0 * pi * x);
        return 2.0 * pi * std::exp(-(r - rho) * (r - rho) / (2.0 * sigma * sigma)) * bessel;
    };
    const auto plain = [&](double rho) { return -pekeris_g(ct / rho) * ring(rho); };
    const double reach = r + 9.0 * sigma;
    double sum = integrate(0.0, std::min(reach, ct / gamma), 400, plain);
    // From the Rayleigh arrival on, rho = ct / gamma + s^2 removes the square root from the
    // denominator.
    const double r1 = ct / gamma, r2 = ct, r3 = ct * std::sqrt(3.0);
    const auto rooted = [&](double s) { return 2.0 * s * plain(r1 + s * s); };
    if (reach > r1) sum += integrate(0.0, std::sqrt(std::min(reach, r2) - r1), 400, rooted);
    if (reach > r2) sum += integrate(r2, std::min(reach, r3), 400, plain);
    return sum / (32.0 * pi * mu);
}

static Case point_load(const Layer& layer, double fwhm_m) {
    Case c;
    c.scene.medium = test::half_space(layer);
    c.scene.load.peak_Pa = 1.0;
    c.scene.load.footprint = GaussianFootprint{fwhm_m};
    c.scene.load.modulation = {.kind = "AM", .trajectory = {{Hold{}}}};
    c.domain = {320, 320, 0.5e-3, 0.0};
    c.time = {480, 12.5e-6};
    c.measure = {.at_s = 6e-3, .settled_after_s = 0.0, .focal_radius_m = 2e-3};
    c.solver = LayeredOptions{};
    return c;
}

TEST_CASE("Lamb's problem: response to a step load equals the closed form of Pekeris", "[verify]") {
    // The domain is 160 mm wide: the P wave of the first image (8.7 m/s) needs 17 ms to the
    // receiver. The focus of 2 mm is resolved by four points; its spectrum at the Nyquist
    // wavenumber is 1e-6.
    const Layer layer = poisson_solid();
    const double fwhm = 2e-3, sigma = fwhm / (2.0 * std::sqrt(2.0 * std::numbers::ln2));
    const Case c = point_load(layer, fwhm);
    const auto frames = test::frames_of(c);
    const double r = 10e-3;
    const auto receiver = [&](std::ptrdiff_t n) {
        return frames.at(n)[static_cast<std::size_t>((160 + 20) * 320 + 160)];
    };
    for (const double tau : {0.7, 0.9, 1.2, 1.5, 2.0, 3.0}) {
        const auto n = static_cast<std::ptrdiff_t>(std::llround(tau * r / 5.0 / 12.5e-6)) - 1;
        const double exact = lamb_gaussian(r, c.time.frame_s(n), sigma, layer);
        CAPTURE(tau, exact, receiver(n));
        CHECK(std::abs(receiver(n) / exact - 1.0) < 0.01); // required
    }
    // Static limit (1 - nu) F / (2 pi mu r), corrected for the size of the footprint: at a distance
    // of 3 sigma or more the mean of 1/r over a Gaussian is 1/r (1 + sigma^2 / 2 r^2 + ...).
    const double force = 2.0 * pi * sigma * sigma;
    const double still = 0.75 * force / (2.0 * pi * static_shear_modulus(layer) * r) *
                         (1.0 + 0.5 * std::pow(sigma / r, 2) + 9.0 / 8.0 * std::pow(sigma / r, 4));
    CHECK(std::abs(receiver(479) / still - 1.0) < 0.003); // required
}

TEST_CASE("closed form for a finite size converges to that of a point load", "[verify]") {
    // Verification of the reference: a narrow Gaussian must yield the force times the point
    // solution.
    const Layer layer = poisson_solid();
    const double sigma = 2e-5, r = 10e-3, force = 2.0 * pi * sigma * sigma;
    for (const double tau : {0.7, 0.9, 1.5, 3.0}) {
        const double scale = force / (32.0 * pi * static_shear_modulus(layer) * r);
        // Relative to the static solution, 12: sigma / r is 0.002, and g is smooth here.
        CHECK(std::abs(lamb_gaussian(r, tau * r / 5.0, sigma, layer) / scale + pekeris_g(tau)) <
              12.0 * 1e-4);
    }
}

TEST_CASE("static displacement at depth equals Boussinesq's solution", "[verify]") {
    // 12 ms after a step the shear waves have travelled away (60 mm), and the P waves of the images
    // (104 of 112 mm) have not arrived. On the axis below a Gaussian:
    //     u_z(z) = integral of p(rho) [z^2 / R^2 + 2 (1 - nu)] / (4 pi mu R) 2 pi rho d rho.
    const Layer layer = poisson_solid();
    const double fwhm = 2e-3, sigma = fwhm / (2.0 * std::sqrt(2.0 * std::numbers::ln2));
    Case c = point_load(layer, fwhm);
    c.domain = {150, 150, 0.75e-3, 0.0};
    c.time = {4, 3e-3};
    c.measure.depths_m = {0.0, 1e-3, 4e-3, 8e-3};
    const auto frames = test::frames_of(c);
    for (std::size_t d = 0; d < c.measure.depths_m.size(); ++d) {
        const double z = c.measure.depths_m[d];
        const double exact = integrate(0.0, 9.0 * sigma, 200, [&](double rho) {
            const double distance = std::hypot(rho, z);
            return std::exp(-rho * rho / (2.0 * sigma * sigma)) * rho *
                   (z * z / (distance * distance) + 1.5) /
                   (2.0 * static_shear_modulus(layer) * distance);
        });
        const double computed = frames.at(3, d)[75 * 150 + 75];
        CAPTURE(z, exact, computed);
        // The remaining transient of the step decreases as a power of time (0.5 % at 6 ms, 8 mm).
        CHECK(std::abs(computed / exact - 1.0) < 0.003);
    }
}

TEST_CASE("response to a steady load below the Rayleigh speed equals the closed form", "[verify]") {
    // Lateral profile of a 3 mm focus at 3 m/s: the point solution of docs/explanation/
    // physics.md, convolved with the Gaussian. nu = 0.25: the P waves of the images (8.7 m/s, 121
    // mm) have not arrived by 14 ms.
    const double v = 3.0;
    Case c = test::moving_focus(test::half_space(poisson_solid()), ConstantSpeed{v});
    c.domain = {320, 320, 0.75e-3, 0.0};
    c.time = {280, 50e-6};
    auto& travel = test::travel_of(c);
    std::get<Line>(travel.path.shape).from_m = {
        -42e-3, 0.0}; // at 14 ms the focus is at the grid point at 0
    const auto frames = test::frames_of(c);

    const Layer& layer = c.scene.medium.layers[0];
    const double mu = static_shear_modulus(layer);
    const double sigma = 3e-3 / (2.0 * std::sqrt(2.0 * std::numbers::ln2));
    // r u_z of a point load of 1 N at the angle theta to the direction of motion.
    const auto angular = [&](double theta) {
        const double ms2 = std::pow(v * std::sin(theta) / layer.c_s_m_s, 2);
        const double mp2 = std::pow(v * std::sin(theta) / layer.c_p_m_s, 2);
        const double limit = 1.0 / (2.0 * (1.0 - std::pow(layer.c_s_m_s / layer.c_p_m_s, 2)));
        if (ms2 < 1e-10) return limit / (2.0 * pi * mu);
        const double rayleigh = 4.0 * std::sqrt((1.0 - mp2) * (1.0 - ms2)) - std::pow(2.0 - ms2, 2);
        return ms2 * std::sqrt(1.0 - mp2) / rayleigh / (2.0 * pi * mu);
    };
    // Polar coordinates around the receiver (0, y): the 1/r of the point solution cancels the
    // Jacobian.
    const auto exact = [&](double y) {
        return integrate(0.0, 2.0 * pi, 60, [&](double phi) {
            // The load element is at the distance rho in the direction phi from the receiver. The
            // direction from the load element to the receiver is the opposite one; only the
            // magnitude of its sine matters.
            return angular(phi) * integrate(0.0, y + 9.0 * sigma, 40, [&](double rho) {
                       const double dx = rho * std::cos(phi), dy = y + rho * std::sin(phi);
                       return std::exp(-(dx * dx + dy * dy) / (2.0 * sigma * sigma));
                   });
        });
    };
    const auto& surface = frames.at(279);
    for (const std::ptrdiff_t j : {0, 2, 4, 8, 12, 20, 28}) {
        const double y = static_cast<double>(j) * 0.75e-3;
        const double computed = surface[static_cast<std::size_t>(160 * 320 + 160 + j)];
        CAPTURE(y, computed, exact(y));
        CHECK(std::abs(computed / exact(y) - 1.0) < 0.03); // required
    }
}

} // namespace test_lamb
