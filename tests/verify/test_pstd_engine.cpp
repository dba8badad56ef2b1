// SPDX-License-Identifier: BSD-3-Clause
#include "support/orders.hpp"
#include "support/spectral_cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

namespace test_pstd_engine {

using namespace shearwake;

struct NodeFluid {
    double density_kg_m3, c_p_m_s;
};

/// A focus at a fixed position that is switched on and off, over soft tissue of c_p/c_s = 10, for 4
/// ms.
static Case resting_focus(const SolverOptions& solver, double fwhm_m, double spacing_m) {
    Case c = test::moving_focus(test::half_space(test::tissue(50.0, 1.0)), ConstantSpeed{1.0});
    c.scene.load.footprint = GaussianFootprint{fwhm_m};
    c.scene.load.modulation.trajectory = {{Hold{{0.0, 0.0}}}};
    c.scene.load.modulation.envelope = {{SineGain{.frequency_Hz = 250.0}}};
    const auto points = good_even_length(std::lround(36e-3 / spacing_m));
    c.domain = {points, points, spacing_m, 0.0};
    c.time = {16, 250e-6};
    c.measure.at_s = 4e-3;
    c.solver = solver;
    return c;
}

using Complex = std::complex<double>;
using Response = std::function<Complex(double k, Complex omega)>; // W/p at z = 0

/// sqrt(k^2 - omega^2/c^2), the root of the decaying solution.
static Complex decay(double k, Complex omega, Complex c2) {
    const Complex root = std::sqrt(k * k - omega * omega / c2);
    return root.real() < 0.0 ? -root : root;
}

/// A sheet of force in a full space: one half acts on each side, where U = 0 by symmetry.
static Complex full_space(const Layer& layer, double k, Complex omega) {
    const double rho = layer.density_kg_m3;
    const Complex alpha = decay(k, omega, p_wave_modulus(layer, omega) / rho),
                  beta = decay(k, omega, shear_modulus(layer, omega) / rho);
    return (k * k / beta - alpha) / (2.0 * rho * omega * omega);
}

/// The half-space of docs/explanation/engine-layered.md with a fluid above that moves along with
/// it; the pressure of the fluid is rho omega^2 W / alpha with the fluid's alpha.
static Complex below_fluid(const Layer& layer, const NodeFluid& fluid, double k, Complex omega) {
    const double rho = layer.density_kg_m3;
    const Complex mu = shear_modulus(layer, omega), ks2 = rho * omega * omega / mu;
    const Complex alpha = decay(k, omega, p_wave_modulus(layer, omega) / rho),
                  beta = decay(k, omega, mu / rho);
    const Complex twice = 2.0 * k * k - ks2;
    const Complex free = -alpha * ks2 / (mu * (twice * twice - 4.0 * k * k * alpha * beta));
    const Complex pushed =
        fluid.density_kg_m3 * omega * omega / decay(k, omega, fluid.c_p_m_s * fluid.c_p_m_s);
    return free / (1.0 - free * pushed);
}

/// u_z at the centre of a resting focus for each frame: a sum over the modes of the periodic
/// domain, at complex frequencies that prevent periodicity in time.
static std::vector<double> centre_of(const Case& c, const Response& response) {
    const std::ptrdiff_t count = 256, n = c.domain.nx;
    const double period_s = 2.0 * c.time.duration_s(), dt_s = period_s / count,
                 eps = std::log(1e6) / period_s,
                 dk = 2.0 * std::numbers::pi / c.domain.extent_x_m();
    std::vector<double> centre(static_cast<std::size_t>(c.time.frames), 0.0);
    for (std::ptrdiff_t m = -count / 2; m < count / 2; ++m) {
        const Complex omega(2.0 * std::numbers::pi * static_cast<double>(m) / period_s, -eps);
        Complex load = 0.0;
        for (std::ptrdiff_t t = 0; t < count; ++t)
            load += dt_s * amplitude(c.scene.load, dt_s * static_cast<double>(t)) *
                    std::exp(-Complex(0.0, 1.0) * omega * (dt_s * static_cast<double>(t)));
        Complex sum = 0.0;
        for (std::ptrdiff_t i = 0; i < n / 2; ++i) {
            for (std::ptrdiff_t j = 0; j < n / 2; ++j) {
                const double kx = dk * static_cast<double>(i), ky = dk * static_cast<double>(j);
                const double both = (i == 0 ? 1.0 : 2.0) * (j == 0 ? 1.0 : 2.0);
                sum += both * spectrum(c.scene.load.footprint, kx, ky) *
                       response(std::hypot(kx, ky), omega);
            }
        }
        sum *= load / (c.domain.extent_x_m() * c.domain.extent_y_m() * period_s);
        for (std::size_t f = 0; f < centre.size(); ++f)
            centre[f] += (sum * std::exp(Complex(0.0, 1.0) * omega *
                                         c.time.frame_s(static_cast<std::ptrdiff_t>(f))))
                             .real();
    }
    return centre;
}

/// Relative L2 difference at the centre.
static double centre_error(const PstdOptions& options, const Response& response) {
    const Case c = resting_focus(options, 9e-3, 1.5e-3);
    const auto stepped = test::frames_of(c);
    const std::vector<double> exact = centre_of(c, response);
    std::vector<double> centre;
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
        centre.push_back(stepped.at(
            n)[static_cast<std::size_t>(c.domain.nx / 2 * c.domain.ny + c.domain.ny / 2)]);
    return test::relative_l2(centre, exact);
}

static double error_of(const PstdOptions& options, double fwhm_m, double spacing_m) {
    const auto exact = test::frames_of(resting_focus(LayeredOptions{}, fwhm_m, spacing_m));
    const auto stepped = test::frames_of(resting_focus(options, fwhm_m, spacing_m));
    return test::relative_l2(stepped, exact, 16);
}

/// Relative L2 difference of the effect of a sphere, of 4 mm at a depth of 12 mm, on the surface at
/// 6 ms.
static double effect_apart(double contrast, double per_radius) {
    constexpr double radius_m = 4e-3;
    const auto effect = [&](const SolverOptions& solver) {
        Case c = test::moving_focus(test::half_space(test::tissue(25.0, 0.5)), ConstantSpeed{1.0});
        c.scene.load.footprint = GaussianFootprint{5e-3};
        c.scene.load.modulation.trajectory = {{Hold{{2e-3, 0.0}}}};
        c.scene.load.modulation.envelope = {{SineGain{.frequency_Hz = 200.0}}};
        const auto points = std::lround(8.0 * per_radius);
        c.domain = {points, points, radius_m / per_radius, 0.0};
        c.time = {12, 500e-6};
        c.measure.at_s = 6e-3;
        c.solver = solver;
        const auto without = test::frames_of(c).at(11);
        c.scene.medium.bodies = {{.name = "sphere",
                                  .shape = Ellipsoid{{radius_m, radius_m, radius_m}},
                                  .centre_m = {0.13e-3, 0.21e-3, 12e-3},
                                  .c_s_m_s = 5.0 * std::sqrt(contrast)}};
        auto change = test::frames_of(c).at(11);
        for (std::size_t i = 0; i < change.size(); ++i)
            change[i] -= without[i];
        return change;
    };
    PstdOptions pstd;
    pstd.depth_m = 18e-3;
    return test::relative_l2(effect(pstd), effect(SpectralOptions{.time_step_s = 25e-6}));
}

TEST_CASE("a sphere has the same effect in the engines pstd and spectral", "[pstd][extended]") {
    const double difference = effect_apart(4.0, 4.0);
    CAPTURE(difference);
    // Observed 3.2 % at 4 spacings per radius; the cells are isotropic at nodes, and the derivative
    // oscillates below the skin.
    CHECK(difference < 0.045);
}

TEST_CASE("spheres have the same effect in the engines pstd and spectral on a finer grid",
          "[long][pstd][extended]") {
    struct Sphere {
        double contrast, most;
    };
    // Observed 4.0, 2.4 and 5.9 %.
    const auto of = GENERATE(Sphere{0.3, 0.05}, Sphere{4.0, 0.035}, Sphere{16.0, 0.08});
    const double difference = effect_apart(of.contrast, 6.0);
    CAPTURE(of.contrast, difference);
    CHECK(difference < of.most);
}

TEST_CASE("engine pstd converges to the exact engine", "[pstd]") {
    // Measured without a medium above the skin, on these grids: 1.8 % and 0.7 %.
    const double coarse = error_of(PstdOptions{}, 6e-3, 1.5e-3);
    const double fine = error_of(PstdOptions{}, 9e-3, 1.5e-3);
    INFO("relative L2 difference of the surface field " << coarse << " and " << fine
                                                        << " at 4 and 6 points per width");
    CHECK(coarse < 0.025);
    CHECK(fine < 0.01);
    // Better than the first order that the engine reports.
    test::check_order("pstd, grid spacing, free surface", 1.0,
                      std::log(coarse / fine) / std::log(6.0 / 4.0), 0.0);
}

TEST_CASE("engine pstd equals the closed forms for a full space and for skin below a fluid",
          "[pstd]") {
    const Layer tissue = test::tissue(50.0, 1.0);
    PstdOptions options;
    options.top = PstdTop::continued;
    const double full = centre_error(
        options, [&](double k, Complex omega) { return full_space(tissue, k, omega); });
    options.top = PstdTop::fluid;
    options.fluid_density_kg_m3 = 800.0;
    options.fluid_c_p_m_s = 30.0;
    const double wet = centre_error(options, [&](double k, Complex omega) {
        return below_fluid(tissue, {800.0, 30.0}, k, omega);
    });
    INFO("relative L2 difference at the centre " << full << " and " << wet);
    // Measured: 0.3 % and 5.1 %. u_x is discontinuous between skin and fluid, where the derivatives
    // oscillate: 6.8 / 5.4 / 4.8 / 4.0 % at 3 / 4.5 / 6 / 9 points per width on 60 mm; 1.2 / 0.5 /
    // 0.3 / 0.1 % without the fluid.
    CHECK(full < 0.005);
    CHECK(wet < 0.06);
}

TEST_CASE("engine pstd with an internal fluid agrees with engine spectral with the softest solid",
          "[long][pstd]") {
    // A sheet of fluid of 5 points thickness across the domain, 9 mm below the skin.
    const auto surface = [](const SolverOptions& solver, std::optional<double> c_s_m_s) {
        Case c = resting_focus(solver, 9e-3, 1.5e-3);
        if (c_s_m_s)
            c.scene.medium.bodies = {{.name = "sheet",
                                      .shape = Box{{0.2, 0.2, 7.5e-3}},
                                      .centre_m = {0.0, 0.0, 12.75e-3},
                                      .c_p_m_s = 50.0,
                                      .c_s_m_s = c_s_m_s,
                                      .viscosity_Pa_s = 0.0}};
        return test::frames_of(c);
    };
    const auto without = surface(PstdOptions{}, {}), fluid = surface(PstdOptions{}, 0.0);
    const auto soft = surface(SpectralOptions{.time_step_s = 50e-6}, 0.2);
    const double changed = test::relative_l2(fluid, without, 16),
                 off = test::relative_l2(fluid, soft, 16);
    INFO("the sheet changes the surface field by " << changed << ", the engines differ by " << off);
    CHECK(changed > 0.1);
    // Observed: 2.1 %, of which 0.7 % also occur without a sheet. Its faces end between nodes for
    // one engine and are averaged over elements by the other one, which has a wave of 0.2 m/s in
    // the sheet.
    CHECK(off < 0.03);
}

} // namespace test_pstd_engine
