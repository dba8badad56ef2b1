// SPDX-License-Identifier: BSD-3-Clause
// Verifies the waves emitted by the sources of engine "pstd".
#include "support/on_root.hpp"
#include "support/pstd_line.hpp"
#include "support/pstd_sources.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace test_pstd_sources {

using namespace shearwake;
using namespace shearwake::pstd;
using test::alone;

constexpr double dx_m = 1e-3, dz_m = 0.8e-3, dt_s = 4e-6;
const pstd::NodeMaterial solid{1000.0, 20.0, 5.0};

/// A plane source in the middle of a line and the expected wave `away` nodes further.
struct Plane {
    pstd::Field source, received;
    double speed_m_s;
    double amplitude; // of the received field, for a source value of 1
};

TEST_CASE("an additive plane source emits the amplitude that follows from its scaling", "[pstd]") {
    // If f is added to one plane in each step, waves of f d/(2 c dt) travel to both sides. k-Wave
    // adds 2 c_p dt/dz times the value to a velocity, 2 c_p dt/dx to a normal stress and two thirds
    // of this to a shear stress, with dx and c_p for any direction and wave.
    const Plane plane = GENERATE(
        Plane{pstd::Field::uz, pstd::Field::uz, 20.0, 1.0},
        Plane{pstd::Field::szz, pstd::Field::szz, 20.0, dz_m / dx_m},
        Plane{pstd::Field::szz, pstd::Field::uz, 20.0, -dz_m / dx_m / (1000.0 * 20.0)},
        Plane{pstd::Field::sxz, pstd::Field::sxz, 5.0, 2.0 / 3.0 * (20.0 / 5.0) * dz_m / dx_m});
    const std::ptrdiff_t points = 400, middle = 200, away = 60;
    pstd::Setup setup = test::pstd_line(points, dz_m, dt_s, [](std::ptrdiff_t) { return solid; });
    setup.grid.spacing_m = {dx_m, dx_m, dz_m};
    const double width_s = 12.0 * dz_m / plane.speed_m_s, centre_s = 4.5 * width_s;
    const auto pulse = [&](double t_s) {
        const double a = (t_s - centre_s) / width_s;
        return std::exp(-0.5 * a * a);
    };
    pstd::Source source{.field = plane.source};
    source.nodes = {{0, 0, middle}};
    const double end_s = 14.0 * width_s;
    std::vector<double> series;
    for (int n = 0; n * dt_s < 9.0 * width_s; ++n)
        series.push_back(pulse(n * dt_s));
    setup.sources.push_back(test::separable_source(source, {3.0}, series));
    pstd::Stepper<double> stepper(setup, alone());
    const pstd::Node receiver{0, 0, middle + away};
    const double half = 0.5 * dz_m; // staggered fields
    const double distance_m = away * dz_m + (pstd::is_staggered(plane.received, 2) ? half : 0.0) -
                              (pstd::is_staggered(plane.source, 2) ? half : 0.0);
    double apart = 0.0, largest = 0.0;
    while (static_cast<double>(stepper.steps()) * dt_s < end_s) {
        stepper.step();
        const double got = values_at<double>(stepper, plane.received, {&receiver, 1}, alone())[0];
        // Sample n is added between u((n - 1/2) dt) and u((n + 1/2) dt), or between s(n dt) and
        // s((n + 1) dt), and therefore belongs to the middle of this interval.
        const double n = static_cast<double>(stepper.steps());
        const double t_s = dt_s * (n - (pstd::is_velocity(plane.received) ? 0.5 : 0.0) -
                                   (pstd::is_velocity(plane.source) ? 0.0 : 0.5));
        const double wanted = 3.0 * plane.amplitude * pulse(t_s - distance_m / plane.speed_m_s);
        apart = test::worse(apart, std::abs(got - wanted));
        largest = std::max(largest, std::abs(wanted));
    }
    INFO("difference " << apart / largest << " of the amplitude");
    // The pulse is cut off at 4.5 widths, 4e-5; a shift of P by half a step would cause 3e-3.
    CHECK(apart < 2e-4 * largest);
    CHECK(largest > 0.99 * 3.0 * std::abs(plane.amplitude));
}

TEST_CASE("a prescribed normal stress has the given value and a shear stress two thirds of it",
          "[pstd]") {
    const auto [field, share] =
        GENERATE(std::pair{pstd::Field::szz, 1.0}, std::pair{pstd::Field::sxz, 2.0 / 3.0});
    const bool layer = GENERATE(false, true); // also where the parts are stored separately
    pstd::Setup setup;
    setup.grid = {{12, 10, 14}, {1e-3, 1e-3, 1e-3}, 1e-5};
    setup.pml.points = {4, 4, 4};
    if (!layer) setup.pml.strength_1 = {0.0, 0.0, 0.0};
    setup.material = [](pstd::Node) { return solid; };
    pstd::Source source{.field = field, .mode = pstd::SourceMode::dirichlet};
    for (std::ptrdiff_t x = 0; x < 12; ++x)
        for (std::ptrdiff_t y = 0; y < 10; ++y)
            source.nodes.push_back({x, y, 5});
    std::vector<double> pattern;
    for (const pstd::Node& n : source.nodes)
        pattern.push_back(std::sin(1.0 + static_cast<double>(3 * n[0] + n[1])));
    const std::vector<double> series = {1.0, 2.0, -3.0, 0.5, 4.0};
    setup.sources.push_back(test::separable_source(source, pattern, series));
    pstd::Stepper<double> stepper(setup, alone());
    double apart = 0.0;
    for (const double now : series) {
        stepper.step();
        const auto got = values_at<double>(stepper, field, source.nodes, alone());
        for (std::size_t i = 0; i < got.size(); ++i)
            apart = test::worse(apart, std::abs(got[i] - share * now * pattern[i]));
    }
    CHECK(apart < 4e-15); // sum of thirds of up to 4
    // Released after its last sample.
    stepper.step();
    const double after = values_at<double>(stepper, field, source.nodes, alone())[0];
    CHECK(std::abs(after - share * series.back() * pattern[0]) > 1e-3);
}

TEST_CASE("fields stored as sums equal fields stored as parts", "[pstd]") {
    // An absorbing layer whose factors are all 1 requires separate parts wherever it is:
    // everywhere, for all axes or for those of one axis.
    const pstd::Node layer = GENERATE(pstd::Node{6, 5, 7}, pstd::Node{0, 0, 7}, pstd::Node{6, 0, 0},
                                      pstd::Node{2, 5, 0});
    const pstd::Absorption absorption =
        GENERATE(pstd::Absorption::none, pstd::Absorption::kelvin_voigt);
    const auto run = [&](double strength) {
        pstd::Setup setup;
        setup.grid = {{12, 9, 14}, {1e-3, 1.1e-3, 0.9e-3}, 5e-6};
        setup.pml.points = layer;
        setup.pml.strength_1 = {strength, strength, strength};
        setup.absorption = absorption;
        setup.material = [](pstd::Node n) {
            return pstd::NodeMaterial{1000.0, 20.0, n[2] > 6 ? 8.0 : 5.0, 0.05, 0.02};
        };
        for (const pstd::Field field : {pstd::Field::ux, pstd::Field::syy, pstd::Field::sxz}) {
            pstd::Source source{.field = field};
            source.nodes = {{3, 4, 5}, {8, 2, 9}};
            setup.sources.push_back(test::separable_source(source, {1.0, -0.5}, {1.0, 2.0, 1.0}));
        }
        pstd::Stepper<double> stepper(setup, alone());
        for (int n = 0; n < 200; ++n)
            stepper.step();
        std::vector<double> totals;
        for (const pstd::Field field : {pstd::Field::ux, pstd::Field::uy, pstd::Field::uz,
                                        pstd::Field::sxx, pstd::Field::syz})
            for (const double v : stepper.total(field))
                // Convert all to Pa.
                totals.push_back(pstd::is_velocity(field) ? v * 1000.0 * 20.0 : v);
        return totals;
    };
    const auto kept = run(1e-300), added = run(0.0);
    double apart = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        apart = test::worse(apart, std::abs(kept[i] - added[i]));
        largest = std::max(largest, std::abs(added[i]));
    }
    CHECK(apart < 1e-12 * largest); // rounding errors of 200 steps
    CHECK(largest > 0.0);
}

} // namespace test_pstd_sources
