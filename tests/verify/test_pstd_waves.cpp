// SPDX-License-Identifier: BSD-3-Clause
#include "support/on_root.hpp"
#include "support/pstd_recording.hpp"
#include "support/pstd_sources.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <numbers>

namespace test_pstd_waves {

using namespace shearwake;
using namespace shearwake::pstd;
using test::alone;

constexpr double pi = std::numbers::pi;
constexpr double density_kg_m3 = 1000.0, c_p_m_s = 20.0, c_s_m_s = 5.0, dz_m = 1e-3;

/// A wave that travels along z: its velocity component, its stress component and its speed.
struct Wave {
    pstd::Field velocity, stress;
    double speed_m_s;
};
const Wave p_wave{pstd::Field::uz, pstd::Field::szz, c_p_m_s};
const Wave s_wave{pstd::Field::ux, pstd::Field::sxz, c_s_m_s};

/// A line of nodes along z, uniform in x and y.
static pstd::Setup line(std::ptrdiff_t points, double dt_s) {
    pstd::Setup s;
    s.grid = {{1, 1, points}, {1e-3, 1e-3, dz_m}, dt_s};
    s.pml.strength_1 = {0.0, 0.0, 0.0};
    s.material = [](pstd::Node) { return pstd::NodeMaterial{density_kg_m3, c_p_m_s, c_s_m_s}; };
    return s;
}

/// One unscaled sample at all nodes of a line: the total increases by `value` of the node.
static pstd::Source at_once(pstd::Field field, std::ptrdiff_t points,
                            const std::function<double(double)>& value) {
    pstd::Source s{.field = field, .scaling = pstd::SourceScaling::none};
    std::vector<double> values;
    for (std::ptrdiff_t k = 0; k < points; ++k) {
        s.nodes.push_back({0, 0, k});
        const double z_m =
            dz_m * (static_cast<double>(k) + (pstd::is_staggered(field, 2) ? 0.5 : 0.0));
        // A shear stress consists of two parts, which get a third each.
        values.push_back(value(z_m) * (test::is_shear(field) ? 1.5 : 1.0));
    }
    return test::sampled_source(s, values);
}

static std::vector<double> line_of(const pstd::Stepper<double>& stepper, pstd::Field field,
                                   const Comm& team) {
    return values_in<double>(stepper, field, {{0, 0, 0}, {1, 1, stepper.slabs().nz()}}, team);
}

static std::complex<double> mode_of(const std::vector<double>& values, double k_rad_m) {
    std::complex<double> sum = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i)
        sum += values[i] * std::polar(1.0, -k_rad_m * dz_m * static_cast<double>(i));
    return sum;
}

/// u = cos(k z - w t): the velocity at dt/2 and the stress -rho c cos at 0 are added in step 1.
static void start_travelling(pstd::Setup& setup, const Wave& wave, std::ptrdiff_t points,
                             double k_rad_m, double w_rad_s) {
    setup.sources.push_back(at_once(wave.velocity, points, [=, &setup](double z_m) {
        return std::cos(k_rad_m * z_m - 0.5 * w_rad_s * setup.grid.dt_s);
    }));
    setup.sources.push_back(at_once(wave.stress, points, [=](double z_m) {
        return -density_kg_m3 * wave.speed_m_s * std::cos(k_rad_m * z_m);
    }));
}

TEST_CASE("a plane wave has the phase predicted by the scheme after 20 wavelengths", "[pstd]") {
    const Wave wave = GENERATE(p_wave, s_wave);
    const std::ptrdiff_t points = 48;
    pstd::Setup setup = line(points, 0.3 * dz_m / c_p_m_s);
    const double k_rad_m = 2.0 * pi * 3.0 / (static_cast<double>(points) * dz_m);
    const double half = 0.5 * wave.speed_m_s * k_rad_m * setup.grid.dt_s;
    const double w_rad_s = 2.0 / setup.grid.dt_s * std::asin(half); // sin(w dt/2) = c k dt/2
    start_travelling(setup, wave, points, k_rad_m, w_rad_s);
    pstd::Stepper<double> stepper(setup, alone());
    stepper.step();
    const auto first = mode_of(line_of(stepper, wave.velocity, alone()), k_rad_m);
    const double crossing_s = 20.0 * 2.0 * pi / (k_rad_m * wave.speed_m_s);
    while (static_cast<double>(stepper.steps()) * setup.grid.dt_s < crossing_s)
        stepper.step();
    const double t_s = static_cast<double>(stepper.steps() - 1) * setup.grid.dt_s;
    const auto last = mode_of(line_of(stepper, wave.velocity, alone()), k_rad_m);
    const auto turned = last / first;
    INFO((wave.velocity == pstd::Field::uz ? "P" : "S")
         << ": phase differs by " << std::arg(turned * std::polar(1.0, w_rad_s * t_s))
         << " rad from the scheme's, "
         << std::arg(turned * std::polar(1.0, wave.speed_m_s * k_rad_m * t_s))
         << " from the medium's");
    // Rounding errors of up to 4300 steps.
    CHECK(std::abs(turned - std::polar(1.0, -w_rad_s * t_s)) < 1e-10);
    // Time stepping is second order: w = c k (1 + (c k dt)^2/24 + ...); the next term is 3/640 (c k
    // dt)^4, at most 0.3 % of this one.
    const double ahead = wave.speed_m_s * k_rad_m * t_s * half * half / 6.0;
    CHECK(std::arg(turned * std::polar(1.0, wave.speed_m_s * k_rad_m * t_s)) ==
          Approx(-ahead).epsilon(5e-3));
}

TEST_CASE("absorbing layer reflects less than 1e-4 of a wave at normal incidence", "[pstd]") {
    const Wave wave = GENERATE(p_wave, s_wave);
    // The same pulse with the layer and in a box that is too long for reflections to return.
    const std::ptrdiff_t points = 128, long_points = 1024, source_at = 40;
    const double dt_s = 0.3 * dz_m / c_p_m_s;
    const double width_s = 8.0 * dz_m / wave.speed_m_s; // of the pulse
    const auto trace_of = [&](std::ptrdiff_t n, double strength) {
        pstd::Setup setup = line(n, dt_s);
        setup.pml.strength_1[2] = strength;
        setup.pml.points[2] = 20;
        pstd::Source source{.field = wave.velocity};
        source.nodes = {{0, 0, source_at + (n - points) / 2}};
        std::vector<double> series;
        for (std::ptrdiff_t i = 0; static_cast<double>(i) * dt_s < 8.0 * width_s; ++i) {
            const double a = (static_cast<double>(i) * dt_s - 4.0 * width_s) / width_s;
            series.push_back(-a * std::exp(-a * a));
        }
        setup.sources.push_back(test::separable_source(source, {1e-3}, series));
        pstd::Stepper<double> stepper(setup, alone());
        std::vector<double> trace;
        const pstd::Node receiver{0, 0, source_at + 20 + (n - points) / 2};
        const double end_s = 8.0 * width_s + 200.0 * dz_m / wave.speed_m_s;
        while (static_cast<double>(stepper.steps()) * dt_s < end_s) {
            stepper.step();
            trace.push_back(
                values_at<double>(stepper, wave.velocity, std::span(&receiver, 1), alone())[0]);
        }
        return trace;
    };
    const auto absorbed = trace_of(points, 2.0), free = trace_of(long_points, 0.0);
    double largest = 0.0, apart = 0.0;
    for (std::size_t i = 0; i < free.size(); ++i) {
        largest = std::max(largest, std::abs(free[i]));
        apart = test::worse(apart, std::abs(absorbed[i] - free[i]));
    }
    INFO((wave.velocity == pstd::Field::uz ? "P" : "S") << " reflected: " << apart / largest);
    CHECK(apart < 1e-4 * largest);
    CHECK(largest > 0.0);
}

TEST_CASE("decay of a Kelvin-Voigt medium equals theory", "[pstd]") {
    const Wave wave = GENERATE(p_wave, s_wave);
    const std::ptrdiff_t points = 48;
    pstd::Setup setup = line(points, 0.02 * dz_m / c_p_m_s);
    const double eta_Pa_s = 0.4, chi_Pa_s = 1.5;
    setup.absorption = pstd::Absorption::kelvin_voigt;
    setup.material = [=](pstd::Node) {
        return pstd::NodeMaterial{density_kg_m3, c_p_m_s, c_s_m_s, chi_Pa_s, eta_Pa_s};
    };
    const double k_rad_m = 2.0 * pi * 3.0 / (static_cast<double>(points) * dz_m);
    const double viscosity =
        wave.velocity == pstd::Field::uz ? chi_Pa_s + 2.0 * eta_Pa_s : eta_Pa_s;
    // rho w^2 = k^2 (rho c^2 + i w E): e^{i w t} decays as e^{-k^2 E t/(2 rho)}.
    const double decay_1_s = 0.5 * k_rad_m * k_rad_m * viscosity / density_kg_m3;
    const double w_rad_s = std::sqrt(std::pow(wave.speed_m_s * k_rad_m, 2) - decay_1_s * decay_1_s);
    setup.sources.push_back(
        at_once(wave.velocity, points, [=](double z_m) { return std::cos(k_rad_m * z_m); }));
    pstd::Stepper<double> stepper(setup, alone());
    // The envelope of the standing wave: its mode at two times that are an integer number of half
    // periods apart.
    const auto half_period =
        static_cast<std::ptrdiff_t>(std::lround(pi / w_rad_s / setup.grid.dt_s));
    const auto amplitude_after = [&](std::ptrdiff_t steps) {
        while (stepper.steps() < steps)
            stepper.step();
        return std::abs(mode_of(line_of(stepper, wave.velocity, alone()), k_rad_m));
    };
    const double first = amplitude_after(half_period), last = amplitude_after(9 * half_period);
    const double expected = decay_1_s * 8.0 * static_cast<double>(half_period) * setup.grid.dt_s;
    INFO((wave.velocity == pstd::Field::uz ? "P" : "S")
         << ": decay relative to theory " << std::log(first / last) / expected << ", Np "
         << expected);
    CHECK(std::log(first / last) == Approx(expected).epsilon(5e-3));
}

} // namespace test_pstd_waves
