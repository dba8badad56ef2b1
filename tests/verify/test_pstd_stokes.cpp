// SPDX-License-Identifier: BSD-3-Clause
#include "support/pstd_recording.hpp"
#include "support/pstd_sources.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_pstd_stokes {

using namespace shearwake;
using namespace shearwake::pstd;

constexpr double pi = std::numbers::pi;
constexpr double density_kg_m3 = 1000.0, c_p_m_s = 10.0, c_s_m_s = 5.0, d_m = 1e-3;
constexpr double force_N = 1e-3, centre_s = 2.4e-3, width_s = 0.6e-3;
constexpr std::ptrdiff_t points = 52, middle = 26;

/// Force relative to force_N: down and up, so that no static field reaches the absorbing layer.
static double pulse(double t_s) {
    const double a = (t_s - centre_s) / width_s;
    return a * std::exp(-a * a);
}

/// Stokes 1849 (Aki and Richards, eq. 4.23): displacement at a distance from a point force along z,
///     4 pi rho u_z = (3 g^2 - 1)/r^3 int_{r/c_p}^{r/c_s} tau F(t - tau) dtau
///                    + g^2/(c_p^2 r) F(t - r/c_p) + (1 - g^2)/(c_s^2 r) F(t - r/c_s),  g = z/r.
static double stokes_u_z_m(pstd::Node away, double t_s) {
    double r2 = 0.0;
    for (const std::ptrdiff_t n : away)
        r2 += std::pow(static_cast<double>(n) * d_m, 2);
    const double r = std::sqrt(r2), g2 = std::pow(static_cast<double>(away[2]) * d_m / r, 2);
    const double from = r / c_p_m_s, to = r / c_s_m_s;
    const int intervals = 400; // Simpson's rule: error far below the test's tolerance
    double near_field = 0.0;
    for (int i = 0; i <= intervals; ++i) {
        const double tau = from + (to - from) * i / intervals;
        const double weight = i == 0 || i == intervals ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
        near_field += weight * tau * pulse(t_s - tau);
    }
    near_field *= (to - from) / (3.0 * intervals);
    return force_N / (4.0 * pi * density_kg_m3) *
           ((3.0 * g2 - 1.0) / (r * r2) * near_field +
            g2 / (c_p_m_s * c_p_m_s * r) * pulse(t_s - from) +
            (1.0 - g2) / (c_s_m_s * c_s_m_s * r) * pulse(t_s - to));
}

TEST_CASE("field of a force in a full space equals the solution of Stokes", "[pstd]") {
    const Comm team = Comm::world().split(Comm::world().rank());
    pstd::Setup setup;
    setup.grid = {{points, points, points}, {d_m, d_m, d_m}, 0.33 * d_m / c_p_m_s};
    setup.material = [](pstd::Node) { return pstd::NodeMaterial{density_kg_m3, c_p_m_s, c_s_m_s}; };
    pstd::Source source{.field = pstd::Field::uz, .scaling = pstd::SourceScaling::none};
    source.nodes = {{middle, middle, middle}};
    const double dt_s = setup.grid.dt_s,
                 per_step = force_N * dt_s / (density_kg_m3 * d_m * d_m * d_m);
    const auto steps = static_cast<std::ptrdiff_t>(7.4e-3 / dt_s);
    std::vector<double> series;
    for (std::ptrdiff_t n = 0; n < steps; ++n)
        series.push_back(pulse(static_cast<double>(n) * dt_s)); // velocities advance across n dt
    setup.sources.push_back(test::separable_source(source, {per_step}, series));

    // Below, to the side and in an oblique direction; all u_z are half a cell down, as the force
    // is.
    const std::vector<pstd::Node> away = {{0, 0, 9}, {10, 0, 0}, {6, -5, 6}};
    std::vector<pstd::Node> receivers;
    for (const pstd::Node& n : away)
        receivers.push_back({middle + n[0], middle + n[1], middle + n[2]});
    pstd::Stepper<double> stepper(setup, team);
    std::vector<double> u_m(away.size()), largest(away.size()), apart(away.size());
    for (std::ptrdiff_t n = 1; n <= steps; ++n) {
        stepper.step();
        const auto v_m_s = values_at<double>(stepper, pstd::Field::uz, receivers, team);
        for (std::size_t i = 0; i < away.size(); ++i) {
            u_m[i] += dt_s * v_m_s[i];
            const double expected_m = stokes_u_z_m(away[i], static_cast<double>(n) * dt_s);
            largest[i] = std::max(largest[i], std::abs(expected_m));
            apart[i] = test::worse(apart[i], std::abs(u_m[i] - expected_m));
        }
    }
    for (std::size_t i = 0; i < away.size(); ++i) {
        INFO("receiver " << i << ": " << apart[i] / largest[i] << " of " << largest[i] << " m");
        // A single node oscillates by 1 % along its axes; reflections of the absorbing layer are
        // 0.5 %.
        CHECK(apart[i] < 0.02 * largest[i]);
    }
}

} // namespace test_pstd_stokes
