// SPDX-License-Identifier: BSD-3-Clause
#include "support/pstd_recording.hpp"
#include "support/pstd_sources.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <numbers>

namespace test_pstd_oblique {

using namespace shearwake;
using namespace shearwake::pstd;

using Complex = std::complex<double>;
using Vector = std::array<double, 3>;
constexpr double density_kg_m3 = 1000.0, c_p_m_s = 20.0, c_s_m_s = 5.0;

static double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static Vector scaled(const Vector& a, double by) {
    return {by * a[0], by * a[1], by * a[2]};
}
static Vector direction(const Vector& a) {
    return scaled(a, 1.0 / std::sqrt(dot(a, a)));
}

enum class Kind { p, s };

/// One plane wave oblique to all axes, with complex amplitudes of e^{i k.x}: a mode of one step,
///     u+ = u + dt/rho i k s,   s+ = s + dt (M i k u+ - E k^2 s/rho),
/// where s k^ = sigma k^, so that u and s are multiplied by `growth` in each step.
struct Mode {
    Vector k_rad_m, polarisation;
    Complex growth, traction_Pa; // at the end of the step, where u is 1 m/s
};

static Mode mode_of(const pstd::Grid& grid, Kind kind, double chi_Pa_s, double eta_Pa_s) {
    constexpr double waves[3] = {1.0, -2.0, 3.0};
    Mode m;
    for (std::size_t a = 0; a < 3; ++a)
        m.k_rad_m[a] = 2.0 * std::numbers::pi * waves[a] /
                       (static_cast<double>(grid.points[a]) * grid.spacing_m[a]);
    const Vector ahead = direction(m.k_rad_m);
    const Vector askew = {0.3, 0.5, -0.8}; // any direction that is not parallel to the wave vector
    m.polarisation = kind == Kind::p ? ahead
                                     : direction({ahead[1] * askew[2] - ahead[2] * askew[1],
                                                  ahead[2] * askew[0] - ahead[0] * askew[2],
                                                  ahead[0] * askew[1] - ahead[1] * askew[0]});
    const double c_m_s = kind == Kind::p ? c_p_m_s : c_s_m_s, dt_s = grid.dt_s;
    const double viscosity_Pa_s = kind == Kind::p ? chi_Pa_s + 2.0 * eta_Pa_s : eta_Pa_s;
    const double k2 = dot(m.k_rad_m, m.k_rad_m);
    const Complex ik(0.0, std::sqrt(k2));
    const double modulus_Pa = density_kg_m3 * c_m_s * c_m_s;
    const Complex a = dt_s / density_kg_m3 * ik, b = dt_s * modulus_Pa * ik;
    const double d = 1.0 - dt_s * viscosity_Pa_s * k2 / density_kg_m3;
    // (u, s) -> (u + a s, b u + (a b + d) s): g^2 - (1 + a b + d) g + d = 0, forward travelling
    const Complex half = 0.5 * (1.0 + a * b + d);
    m.growth = half - Complex(0.0, 1.0) * std::sqrt(d - half * half);
    m.traction_Pa = (m.growth - 1.0) / a; // u+ = 1 + a s = growth
    return m;
}

/// The stress caused by the strain of the polarisation, per unit of traction. Elastic and viscous
/// stress differ by a factor only if chi/lambda equals eta/mu.
static double stress_of(pstd::Field field, const Mode& m, Kind kind) {
    const Vector n = direction(m.k_rad_m);
    constexpr std::size_t pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    const auto& [i, j] = pairs[pstd::index_of(field) - 3];
    if (kind == Kind::s) return n[i] * m.polarisation[j] + n[j] * m.polarisation[i];
    const double mu = c_s_m_s * c_s_m_s, lambda = c_p_m_s * c_p_m_s - 2.0 * mu;
    return ((i == j ? lambda : 0.0) + 2.0 * mu * n[i] * n[j]) / (lambda + 2.0 * mu);
}

static Complex amplitude(pstd::Field field, const Mode& m, Kind kind) {
    if (pstd::is_velocity(field)) return m.polarisation[pstd::index_of(field)];
    return m.traction_Pa * stress_of(field, m, kind);
}

static double value_at(pstd::Field field, const Mode& m, Kind kind, const pstd::Grid& grid,
                       const pstd::Node& n, int step) {
    double phase = 0.0;
    for (std::size_t a = 0; a < 3; ++a)
        phase += m.k_rad_m[a] * grid.spacing_m[a] *
                 (static_cast<double>(n[a]) + (pstd::is_staggered(field, a) ? 0.5 : 0.0));
    return std::real(amplitude(field, m, kind) * std::pow(m.growth, step) * std::polar(1.0, phase));
}

TEST_CASE("oblique plane wave advances as the scheme's own mode on any number of ranks",
          "[mpi][pstd]") {
    const Kind kind = GENERATE(Kind::p, Kind::s);
    const double eta_Pa_s = GENERATE(0.0, 0.1);
    const pstd::Node points =
        GENERATE(pstd::Node{15, 9, 21}, pstd::Node{16, 10, 20}, pstd::Node{7, 12, 18});
    const Comm world = Comm::world();
    pstd::Setup setup;
    setup.grid = {points, {1e-3, 1.2e-3, 0.9e-3}, 0.2 * 0.9e-3 / c_p_m_s};
    setup.pml.strength_1 = {0.0, 0.0, 0.0};
    const double chi_Pa_s = eta_Pa_s * (c_p_m_s * c_p_m_s / (c_s_m_s * c_s_m_s) - 2.0);
    setup.absorption = eta_Pa_s > 0.0 ? pstd::Absorption::kelvin_voigt : pstd::Absorption::none;
    setup.material = [=](pstd::Node) {
        return pstd::NodeMaterial{density_kg_m3, c_p_m_s, c_s_m_s, chi_Pa_s, eta_Pa_s};
    };
    const Mode mode = mode_of(setup.grid, kind, chi_Pa_s, eta_Pa_s);
    // The first step ends with the mode: velocities are added and the stresses caused by them
    // replaced.
    std::vector<pstd::Node> nodes;
    for (std::ptrdiff_t x = 0; x < points[0]; ++x)
        for (std::ptrdiff_t y = 0; y < points[1]; ++y)
            for (std::ptrdiff_t z = 0; z < points[2]; ++z)
                nodes.push_back({x, y, z});
    const int steps = 200;
    for (std::size_t f = 0; f < pstd::field_count; ++f) {
        const auto field = static_cast<pstd::Field>(f);
        const bool velocity = pstd::is_velocity(field);
        pstd::Source source{.field = field,
                            .mode =
                                velocity ? pstd::SourceMode::additive : pstd::SourceMode::dirichlet,
                            .scaling = pstd::SourceScaling::none,
                            .nodes = nodes};
        std::vector<double> values;
        // A shear stress consists of two parts, which get a third each.
        for (const pstd::Node& n : nodes)
            values.push_back(value_at(field, mode, kind, setup.grid, n, 0) *
                             (test::is_shear(field) ? 1.5 : 1.0));
        setup.sources.push_back(test::sampled_source(source, values));
    }
    pstd::Stepper<double> stepper(setup, world);
    for (int n = 0; n < steps; ++n)
        stepper.step();
    double worst = 0.0, moves = 0.0;
    for (std::size_t f = 0; f < pstd::field_count; ++f) {
        const auto field = static_cast<pstd::Field>(f);
        const auto got = values_in<double>(stepper, field, {{0, 0, 0}, points}, world);
        const double scale = std::abs(pstd::is_velocity(field) ? Complex(1.0) : mode.traction_Pa);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const double wanted = value_at(field, mode, kind, setup.grid, nodes[i], steps - 1);
            worst = test::worse(worst, std::abs(got[i] - wanted) / scale);
            moves = std::max(moves, std::abs(wanted) / scale);
        }
    }
    INFO((kind == Kind::p ? "P, eta " : "S, eta ")
         << eta_Pa_s << ", " << points[0] << " x " << points[1] << " x " << points[2] << ": "
         << worst << " of " << moves);
    CHECK(worst < 1e-11); // rounding errors of 200 steps
    CHECK(moves > 1e-2);  // a substantial motion remains
}

} // namespace test_pstd_oblique
