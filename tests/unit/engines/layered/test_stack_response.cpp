// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/stack_response.hpp"

#include "support/cases.hpp"
#include "support/half_space.hpp"

#include <Eigen/Dense>
#include "support/worst.hpp"

#include <catch2/catch.hpp>
#include <numbers>

namespace test_stack_response {

using namespace shearwake;
using Complex = std::complex<double>;

constexpr double pi = std::numbers::pi;

static Complex response(const Medium& medium, Complex omega, double k, double depth_m = 0.0) {
    Complex h;
    layered::StackResponse(medium, omega, std::span(&depth_m, 1)).evaluate(k, std::span(&h, 1));
    return h;
}

/// Wavenumbers from 1 to 6000 1/m with a spacing below the width of any resonance of these stacks.
static std::vector<double> wavenumbers() {
    std::vector<double> k;
    for (double value = 1.0; value <= 6000.0; value *= 1.02)
        k.push_back(value);
    return k;
}

/// Direct reference solution: all four exponentials of every layer (docs/explanation/
/// engine-layered.md) in one dense system. Accurate for moderate k h if k is not much larger than
/// omega / c_s.
static Complex dense_response(const Medium& medium, Complex omega_rad_s, double k_rad_m,
                              double depth_m) {
    // C and A become parallel for k >> omega / c_s, which needs additional digits.
    using Real = long double;
    using Wide = std::complex<Real>;
    using Square = Eigen::Matrix<Wide, 4, 4>;
    using RowOf4 = Eigen::Matrix<Wide, 1, 4>;
    const Wide omega(omega_rad_s);
    const Real k = k_rad_m;
    const auto n = static_cast<Eigen::Index>(medium.layers.size());
    const bool half = medium.base == Base::half_space;
    struct Modes {
        Wide alpha, beta, mu, m;
        Real h;
        // Columns A, B, C, D; rows U, W, sigma_zz, sigma_rz / i; at z from the layer's top.
        Square at(Real k, Real z) const {
            const Wide ea = std::exp(-alpha * z), eb = std::exp(-alpha * (h - z));
            const Wide ec = std::exp(-beta * z), ed = std::exp(-beta * (h - z));
            Square s;
            const RowOf4 u{k * ea, k * eb, beta * ec, -beta * ed};
            const RowOf4 w{-alpha * ea, alpha * eb, -k * ec, -k * ed};
            const RowOf4 du{-k * alpha * ea, k * alpha * eb, -beta * beta * ec, -beta * beta * ed};
            const RowOf4 dw{alpha * alpha * ea, alpha * alpha * eb, k * beta * ec, -k * beta * ed};
            s.row(0) = u;
            s.row(1) = w;
            s.row(2) = m * dw - (m - Real(2) * mu) * k * u;
            s.row(3) = mu * (du + k * w);
            return s;
        }
    };
    std::vector<Modes> layers;
    for (const Layer& layer : medium.layers) {
        Modes modes;
        modes.mu = Wide(shear_modulus(layer, omega_rad_s));
        modes.m = Wide(p_wave_modulus(layer, omega_rad_s));
        const Wide inertia = Real(layer.density_kg_m3) * omega * omega;
        modes.alpha = std::sqrt(k * k - inertia / modes.m);
        modes.beta = std::sqrt(k * k - inertia / modes.mu);
        modes.h = half && &layer == &medium.layers.back() ? 1.0 : layer.thickness_m;
        layers.push_back(modes);
    }
    using Matrix = Eigen::Matrix<Wide, Eigen::Dynamic, Eigen::Dynamic>;
    using Vector = Eigen::Matrix<Wide, Eigen::Dynamic, 1>;
    Matrix a = Matrix::Zero(4 * n, 4 * n);
    Vector b = Vector::Zero(4 * n);
    a.block(0, 0, 2, 4) = layers[0].at(k, 0.0).bottomRows(2);
    b(0) = -1.0; // sigma_zz = -1 Pa
    Eigen::Index row = 2;
    for (Eigen::Index i = 0; i + 1 < n; ++i, row += 4) {
        const auto& upper = layers[static_cast<std::size_t>(i)];
        a.block(row, 4 * i, 4, 4) = upper.at(k, upper.h);
        a.block(row, 4 * i + 4, 4, 4) = -layers[static_cast<std::size_t>(i) + 1].at(k, 0.0);
    }
    if (half) { // no upgoing waves: B = D = 0
        a(row, 4 * n - 3) = 1.0;
        a(row + 1, 4 * n - 1) = 1.0;
    } else {
        a.block(row, 4 * n - 4, 2, 4) = layers.back().at(k, layers.back().h).topRows(2);
    }
    // Stresses exceed displacements by a factor of mu k: scale the rows to the same magnitude.
    for (Eigen::Index r = 0; r < 4 * n; ++r) {
        const Real scale = a.row(r).cwiseAbs().maxCoeff();
        a.row(r) /= scale;
        b(r) /= scale;
    }
    const Vector x = a.fullPivLu().solve(b);
    Real top = 0.0;
    Eigen::Index i = 0;
    while (i + 1 < n && depth_m > top + layers[static_cast<std::size_t>(i)].h) {
        top += layers[static_cast<std::size_t>(i)].h;
        ++i;
    }
    const Wide w =
        (layers[static_cast<std::size_t>(i)].at(k, depth_m - top).row(1) * x.segment(4 * i, 4))(0);
    return Complex(w);
}

static Medium three_layer_skin() {
    const auto layer = [](double thickness_m, double mu_Pa) {
        return Layer{.thickness_m = thickness_m,
                     .density_kg_m3 = 1000.0,
                     .c_p_m_s = 1500.0,
                     .c_s_m_s = std::sqrt(mu_Pa / 1000.0),
                     .loss = KelvinVoigt{1.0}};
    };
    return {{layer(0.1e-3, 1.33e6), layer(2e-3, 13.3e3), layer(18e-3, 5e3)}, Base::rigid};
}

TEST_CASE("response of a half-space equals the closed form", "[layered]") {
    const double c_p = GENERATE(8.0, 50.0, 1500.0);
    const double viscosity = GENERATE(0.0, 1.0);
    const double decay = GENERATE(0.0, 500.0);
    const double f_Hz = GENERATE(0.0, 1.0, 100.0, 700.0, 2000.0);
    const Complex omega(2.0 * pi * f_Hz, -decay);
    const Layer layer = test::tissue(c_p, viscosity);
    double worst = 0.0;
    for (const double k : wavenumbers()) {
        const Complex exact = test::half_space_response(layer, omega, k);
        worst = test::worse(worst, std::abs(response(test::half_space(layer), omega, k) - exact) /
                                       std::abs(exact));
    }
    CHECK(worst < 1e-10); // required; observed 1e-14
}

TEST_CASE("closed form of the half-space is W/p = -alpha ks^2 / (mu R)", "[layered]") {
    // The literal formula is accurate where no cancellation occurs (k near ks).
    const Layer layer = test::tissue();
    const Complex omega(2.0 * pi * 500.0, -300.0);
    const Complex mu = shear_modulus(layer, omega), m = p_wave_modulus(layer, omega);
    const Complex ks2 = 1000.0 * omega * omega / mu, kp2 = 1000.0 * omega * omega / m;
    const double k = 700.0;
    const Complex alpha = std::sqrt(k * k - kp2), beta = std::sqrt(k * k - ks2);
    const Complex rayleigh = std::pow(2.0 * k * k - ks2, 2) - 4.0 * k * k * alpha * beta;
    const Complex literal = -alpha * ks2 / (mu * rayleigh);
    CHECK(std::abs(test::half_space_response(layer, omega, k) / literal - 1.0) < 1e-13);
    // Static and incompressible: p / (2 mu k), downward for a pushing load.
    const Complex still = test::half_space_response(test::tissue(1500.0, 0.0), 0.0, k);
    CHECK(still.real() == Approx(1.0 / (2.0 * 25e3 * k)).epsilon(2e-5)); // (c_s/c_p)^2 = 1e-5
}

TEST_CASE("a fictitious interface does not change the response of a layer", "[layered]") {
    const double cut_m = GENERATE(1e-4, 3e-3, 1.9e-2);
    const double f_Hz = GENERATE(0.0, 10.0, 300.0, 2000.0);
    const Base base = GENERATE(Base::rigid, Base::half_space);
    const Complex omega(2.0 * pi * f_Hz, -500.0);
    Layer whole = test::tissue(1500.0);
    whole.thickness_m = 0.02;
    Layer upper = whole, lower = whole;
    upper.thickness_m = cut_m;
    lower.thickness_m = whole.thickness_m - cut_m;
    const Medium one{{whole}, base}, two{{upper, lower}, base};
    double worst = 0.0;
    for (const double k : wavenumbers())
        for (const double z : {0.0, 1e-3, 2e-3})
            worst = std::max(
                worst, std::abs(response(two, omega, k, z) / response(one, omega, k, z) - 1.0));
    CHECK(worst < 1e-9);
}

TEST_CASE("response of a stack of layers equals the dense reference solution", "[layered]") {
    const Medium medium = three_layer_skin();
    const double f_Hz = GENERATE(50.0, 400.0, 2000.0);
    const double depth_m = GENERATE(0.0, 0.05e-3, 0.1e-3, 1.0e-3, 5e-3);
    const Complex omega(2.0 * pi * f_Hz, -500.0);
    for (const double k : {10.0, 100.0, 400.0, 1000.0}) {
        const Complex twin = dense_response(medium, omega, k, depth_m);
        CAPTURE(k);
        // The moduli of the reference are doubles, and cancellation costs some of its 19 digits.
        CHECK(std::abs(response(medium, omega, k, depth_m) / twin - 1.0) < 1e-10);
    }
}

TEST_CASE("response of a stiff film on soft tissue neither overflows nor loses the film",
          "[layered]") {
    Medium medium = three_layer_skin();
    const Complex omega(2.0 * pi * 200.0, -500.0);
    for (const double kh : {1e-3, 1.0, 10.0, 100.0, 300.0, 1000.0}) {
        const double k = kh / 0.1e-3;
        for (const double z : {0.0, 0.1e-3, 1e-3, 20e-3}) {
            const Complex h = response(medium, omega, k, z);
            CAPTURE(kh, z);
            CHECK(std::isfinite(h.real()));
            CHECK(std::isfinite(h.imag()));
        }
        // For large k h (e^-40 at the film's bottom) the film responds as a half-space.
        if (kh >= 20.0) {
            const Complex film = test::half_space_response(medium.layers.front(), omega, k);
            CHECK(std::abs(response(medium, omega, k) / film - 1.0) < 1e-12);
        }
    }
}

TEST_CASE("displacement vanishes at a rigid base and is continuous at interfaces", "[layered]") {
    const Medium medium = three_layer_skin();
    const Complex omega(2.0 * pi * 150.0, -500.0);
    const double total_m = 0.1e-3 + 2e-3 + 18e-3;
    const double k = 300.0;
    const double surface = std::abs(response(medium, omega, k));
    CHECK(std::abs(response(medium, omega, k, total_m)) < 1e-14 * surface);
    for (const double interface_m : {0.1e-3, 2.1e-3}) {
        const Complex above = response(medium, omega, k, interface_m * (1.0 - 1e-9));
        const Complex below = response(medium, omega, k, interface_m * (1.0 + 1e-9));
        CHECK(std::abs(above / below - 1.0) < 1e-6); // 1e-9 of a millimetre times k
    }
}

TEST_CASE("static compression in a half-space is (1 + k z) exp(-k z) of the load for any material",
          "[layered]") {
    // The plane-strain solution for a periodic load does not depend on Poisson's ratio.
    const double c_p_m_s = GENERATE(50.0, 1500.0);
    const std::vector<double> depths_m = {0.0, 0.3e-3, 2e-3};
    const layered::StackResponse response(test::half_space(test::tissue(c_p_m_s)), {0.0, -1e-4},
                                          depths_m, layered::StackQuantity::compression);
    for (const double k : {10.0, 300.0, 3000.0}) {
        std::vector<Complex> compression(3);
        response.evaluate(k, compression);
        for (std::size_t i = 0; i < 3; ++i) {
            const double kz = k * depths_m[i];
            // Remaining inertia and viscosity: (omega / c_s k)^2 and omega tau, below 1e-8.
            CHECK(std::abs(compression[i] - (1.0 + kz) * std::exp(-kz)) < 1e-7);
        }
    }
}

TEST_CASE("compression equals the load at the surface and is continuous at interfaces",
          "[layered]") {
    Layer top = test::tissue(), below = test::tissue();
    top.thickness_m = 1e-3;
    below.thickness_m = 5e-3;
    below.c_s_m_s = 9.0;
    const Medium medium = {{top, below}, Base::rigid};
    const double step_m = 1e-12; // to both sides of the interface
    const std::vector<double> depths_m = {0.0, 1e-3 - step_m, 1e-3 + step_m};
    const Complex omega = {2.0 * pi * 200.0, -50.0};
    std::vector<Complex> compression(3);
    layered::StackResponse(medium, omega, depths_m, layered::StackQuantity::compression)
        .evaluate(700.0, compression);
    CHECK(std::abs(compression[0] - 1.0) < 1e-12);           // rounding
    CHECK(std::abs(compression[1] - compression[2]) < 1e-8); // the slope over 2e-12 m, rounding
}

TEST_CASE("the tangential displacement keeps the surface free of shear stress", "[layered]") {
    // The displacement along x is d(U / k)/dx. With sigma_xz = 0 at z = 0, U / k has the slope -W.
    const double f_Hz = GENERATE(10.0, 300.0, 2000.0);
    const Complex omega(2.0 * pi * f_Hz, -500.0);
    const Medium medium = three_layer_skin();
    constexpr double h_m = 2e-7;
    const std::vector<double> depths = {0.0, h_m, 2.0 * h_m};
    const layered::StackResponse tangential(medium, omega, depths,
                                            layered::StackQuantity::tangential);
    const layered::StackResponse normal(medium, omega, depths);
    for (const double k : wavenumbers()) {
        std::vector<Complex> u(3), w(3);
        tangential.evaluate(k, u);
        normal.evaluate(k, w);
        const Complex slope = (-3.0 * u[0] + 4.0 * u[1] - u[2]) / (2.0 * h_m);
        // The quotient has an error of (k h)^2 and of 1e-16 u / (h w).
        const double bound = 1e-3 * std::abs(w[0]) + 1e-9 * std::abs(u[0]) / h_m;
        CHECK(std::abs(slope + w[0]) < bound);
    }
    std::vector<Complex> at_zero(3), near_zero(3);
    tangential.evaluate(0.0, at_zero);
    tangential.evaluate(1e-3, near_zero);
    CHECK(std::abs(at_zero[0] - near_zero[0]) < 1e-6 * std::abs(near_zero[0]));
}

TEST_CASE("the loss over depth equals the power of the load", "[layered]") {
    // The loss is an integral over the strains of all depths, the power follows from H at the
    // surface alone. Both are equal by Poynting's theorem.
    Layer film = test::tissue(1500.0, 0.5), dermis = test::tissue(1500.0, 2.0);
    film.thickness_m = 0.3e-3;
    film.c_s_m_s = 20.0;
    dermis.thickness_m = 8e-3;
    dermis.c_s_m_s = 3.0;
    const Medium media[] = {test::half_space(test::tissue(1500.0)),
                            {{film, test::tissue(50.0)}, Base::half_space},
                            {{dermis}, Base::rigid},
                            {{film, dermis}, Base::rigid}};
    for (const Medium& medium : media)
        for (const double frequency_Hz : {7.0, 120.0, 900.0}) {
            const Complex omega = 2.0 * pi * frequency_Hz;
            const double depth_m = 0.0;
            const layered::StackResponse stack(medium, omega, std::span(&depth_m, 1));
            for (const double k : wavenumbers()) {
                INFO(frequency_Hz << " Hz, k = " << k << "/m");
                Complex h;
                stack.evaluate(k, std::span(&h, 1));
                const double power = -omega.real() * h.imag();
                const Complex loss = stack.loss(k);
                // Products of cancelling exponentials lose digits up to k = 20 k_s, and Im H is as
                // small as 1e-3 |H|.
                CHECK(std::abs(loss.real() + loss.imag() - power) < 1e-7 * power);
                if (medium.base == Base::rigid) CHECK(loss.imag() == 0.0);
                if (medium.layers.size() == 1 && medium.base == Base::half_space)
                    CHECK(loss.real() == 0.0);
            }
        }
}

} // namespace test_stack_response
