// SPDX-License-Identifier: BSD-3-Clause
// Normal incidence of waves on interfaces in engine "pstd".
#include "support/on_root.hpp"
#include "support/pstd_line.hpp"
#include "support/pstd_sources.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace test_pstd_interfaces {

using namespace shearwake;
using namespace shearwake::pstd;
using test::alone;

constexpr double d_m = 1e-3, dt_s = 1e-5;
const pstd::NodeMaterial soft{1000.0, 20.0, 5.0}, stiff{1500.0, 30.0, 9.0}, fluid{900.0, 18.0, 0.0};

struct Wave {
    pstd::Field velocity, stress;
    double speed(const pstd::NodeMaterial& m) const {
        return velocity == pstd::Field::uz ? m.c_p_m_s : m.c_s_m_s;
    }
    double impedance(const pstd::NodeMaterial& m) const { return m.density_kg_m3 * speed(m); }
};
const Wave p_wave{pstd::Field::uz, pstd::Field::szz}, s_wave{pstd::Field::ux, pstd::Field::sxz};

/// A Gaussian that is cut off to zero at six widths, where its value is 1.5e-8.
static double bell(double z_m, double width_m) {
    const double a = z_m / width_m;
    // No node lies at the cutoff, where rounding would decide between 0 and e^-18.
    return std::abs(a) > 6.01 ? 0.0 : std::exp(-0.5 * a * a);
}

/// Adds values at all nodes in the first step: a Gaussian of u that travels in the direction +z
/// (ahead 1) or -z (-1), with the stress -+rho c u.
static void start_bell(pstd::Setup& setup, const Wave& wave, const pstd::NodeMaterial& here,
                       double centre_m, double width_m, double ahead) {
    for (const pstd::Field field : {wave.velocity, wave.stress}) {
        const bool velocity = field == wave.velocity;
        pstd::Source source{.field = field, .scaling = pstd::SourceScaling::none};
        // A shear stress consists of two parts, which get a third each; the stress is computed half
        // a step after u.
        const double scale = velocity ? 1.0 : -ahead * wave.impedance(here);
        const double share = test::is_shear(field) ? 1.5 : 1.0;
        const double moved_m = velocity ? 0.0 : 0.5 * ahead * wave.speed(here) * dt_s;
        if (!velocity) source.mode = pstd::SourceMode::dirichlet;
        std::vector<double> values;
        for (std::ptrdiff_t k = 0; k < setup.grid.points[2]; ++k) {
            source.nodes.push_back({0, 0, k});
            const double z_m =
                d_m * (static_cast<double>(k) + (pstd::is_staggered(field, 2) ? 0.5 : 0.0));
            values.push_back(share * scale * bell(z_m - centre_m - moved_m, width_m));
        }
        setup.sources.push_back(test::sampled_source(source, values));
    }
}

/// The value of largest magnitude between two nodes.
static double extreme(const std::vector<double>& line, std::ptrdiff_t from, std::ptrdiff_t to) {
    double most = 0.0;
    for (std::ptrdiff_t k = from; k < to; ++k)
        if (std::abs(line[static_cast<std::size_t>(k)]) > std::abs(most))
            most = line[static_cast<std::size_t>(k)];
    return most;
}

TEST_CASE("amplitudes of reflected and transmitted waves follow from the impedances", "[pstd]") {
    const Wave wave = GENERATE(p_wave, s_wave);
    const auto [first, second] = GENERATE(std::pair{soft, stiff}, std::pair{stiff, soft});
    const std::ptrdiff_t points = 600, boundary = 300;
    pstd::Setup setup =
        test::pstd_line(points, d_m, dt_s, [&, a = first, b = second](std::ptrdiff_t k) {
            return k < boundary ? a : b;
        });
    const double width_m = 14e-3, start_m = 200e-3;
    start_bell(setup, wave, first, start_m, width_m, 1.0);
    pstd::Stepper<double> stepper(setup, alone());
    // Until the reflected wave is at 200 mm again, and the transmitted wave is as far from either
    // end.
    const double fast = wave.speed(first);
    while (static_cast<double>(stepper.steps()) * dt_s < 200e-3 / fast)
        stepper.step();
    const auto u_m_s = test::values_along(stepper, wave.velocity, alone());
    const double z1 = wave.impedance(first), z2 = wave.impedance(second);
    const double back = extreme(u_m_s, 120, 280), on = extreme(u_m_s, 310, 590);
    INFO((wave.velocity == pstd::Field::uz ? "P" : "S")
         << ": reflected " << back << " of " << (z1 - z2) / (z1 + z2) << ", transmitted " << on
         << " of " << 2.0 * z1 / (z1 + z2));
    // The material changes within one of the 14 cells of the Gaussian's width, and the largest node
    // is up to half a cell away from the maximum: (0.5/14)^2/2.
    CHECK(back == Approx((z1 - z2) / (z1 + z2)).margin(4e-3));
    CHECK(on == Approx(2.0 * z1 / (z1 + z2)).margin(4e-3));
}

TEST_CASE("a fluid between solids transmits P waves according to its impedance and no S waves",
          "[pstd]") {
    const Wave wave = GENERATE(p_wave, s_wave);
    const std::ptrdiff_t points = 800, from = 300, to = 500;
    pstd::Setup setup = test::pstd_line(
        points, d_m, dt_s, [&](std::ptrdiff_t k) { return k >= from && k < to ? fluid : soft; });
    start_bell(setup, wave, soft, 200e-3, 14e-3, 1.0);
    pstd::Stepper<double> stepper(setup, alone());
    const double z1 = wave.impedance(soft), z2 = wave.impedance(fluid);
    // The maximum is in the fluid; afterwards the reflected wave is at 200 mm and, for P, the
    // transmitted one beyond the fluid.
    const auto advance_to = [&](double t_s) {
        while (static_cast<double>(stepper.steps()) * dt_s < t_s)
            stepper.step();
        return test::values_along(stepper, wave.velocity, alone());
    };
    if (wave.velocity == pstd::Field::uz) {
        const auto inside = advance_to(100e-3 / 20.0 + 100e-3 / 18.0);
        CHECK(extreme(inside, from + 30, to - 30) == Approx(2.0 * z1 / (z1 + z2)).margin(4e-3));
        const auto beyond = advance_to(100e-3 / 20.0 + 200e-3 / 18.0 + 100e-3 / 20.0);
        CHECK(extreme(beyond, to + 30, points - 30) ==
              Approx(4.0 * z1 * z2 / ((z1 + z2) * (z1 + z2))).margin(4e-3));
        return;
    }
    const auto after = advance_to(200e-3 / 5.0);
    INFO("reflected " << extreme(after, 120, 280) << ", in the fluid "
                      << extreme(after, from + 10, to) << ", beyond " << extreme(after, to, 790));
    CHECK(extreme(after, 120, 280) == Approx(1.0).margin(4e-3)); // a free surface
    // Oscillation of the derivative of a stress that ends in a kink, and of its interpolant.
    CHECK(std::abs(extreme(after, from + 10, points - 10)) < 4e-3);
    const auto sxz = test::values_along(stepper, pstd::Field::sxz, alone());
    CHECK(extreme(sxz, from - 1, to) == 0.0); // zero wherever a node on either side is fluid
}

TEST_CASE("mirror image of solids and fluids yields the mirror image of the field", "[pstd]") {
    const Wave wave = GENERATE(p_wave, s_wave);
    // Fluid on the high side of a solid and on the low side of the next one, at different depths:
    // an error on one side alone would break the symmetry. Both ends, where averaging stops, are
    // identical.
    const std::ptrdiff_t points = 240, from = 90, to = 130;
    const auto run = [&](double ahead) {
        const bool mirrored = ahead < 0.0;
        pstd::Setup setup = test::pstd_line(points, d_m, dt_s, [&](std::ptrdiff_t k) {
            const std::ptrdiff_t z = mirrored ? points - 1 - k : k;
            return z >= from && z < to ? fluid : z >= 170 && z < 200 ? stiff : soft;
        });
        const double length_m = d_m * static_cast<double>(points - 1);
        const double centre_m = mirrored ? length_m - 50e-3 : 50e-3;
        start_bell(setup, wave, soft, centre_m, 8e-3, ahead);
        pstd::Stepper<double> stepper(setup, alone());
        for (int n = 0; n < 900; ++n)
            stepper.step();
        return std::pair{test::values_along(stepper, wave.velocity, alone()),
                         test::values_along(stepper, wave.stress, alone())};
    };
    const auto [u, s] = run(1.0);
    const auto [u_image, s_image] = run(-1.0);
    // Half a cell after node k corresponds to half a cell before its image: k + 1/2 -> n - 2 - k +
    // 1/2. The velocity is the same. The wave travels in the opposite direction, so that the stress
    // has the opposite sign.
    const auto apart = [&](const std::vector<double>& a, const std::vector<double>& b,
                           pstd::Field field, double sign) {
        const std::ptrdiff_t last = pstd::is_staggered(field, 2) ? points - 2 : points - 1;
        double differs = 0.0, largest = 0.0;
        for (std::ptrdiff_t k = 0; k <= last; ++k) {
            const double x = a[static_cast<std::size_t>(k)],
                         y = b[static_cast<std::size_t>(last - k)];
            differs = test::worse(differs, std::abs(x - sign * y));
            largest = std::max(largest, std::abs(x));
        }
        return differs / largest;
    };
    const double of_u = apart(u, u_image, wave.velocity, 1.0),
                 of_s = apart(s, s_image, wave.stress, -1.0);
    INFO("velocity " << of_u << ", stress " << of_s);
    CHECK(of_u < 1e-11); // rounding errors of 900 steps
    CHECK(of_s < 1e-11);
}

} // namespace test_pstd_interfaces
