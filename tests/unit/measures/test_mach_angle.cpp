// SPDX-License-Identifier: BSD-3-Clause
#include "measures/spatial_measures.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <random>

namespace test_mach_angle {

using namespace shearwake;

const Domain domain{.nx = 256, .ny = 192, .spacing_m = 0.75e-3, .sponge_m = 12e-3};
constexpr double rayleigh = 4.777, fwhm = 3e-3, since_start = 14e-3,
                 degrees = std::numbers::pi / 180;

struct Frame {
    Vec2 focus, velocity;
    std::vector<double> u;
    measures::MachFit fit(double c = rayleigh, double t = since_start) const {
        return measures::mach_angle({u.data(), domain.nx, domain.ny}, domain, focus, velocity, c,
                                    fwhm, t);
    }
};

/// Two straight fronts of Gaussian profile at the half-angle, weaker with distance, behind them a
/// tail and before them a shallow trough, as a Rayleigh wake has; noise of the given size.
static Frame wedge(double angle_deg, double speed, double direction_deg, double noise = 0.0) {
    const Vec2 along{std::cos(direction_deg * degrees), std::sin(direction_deg * degrees)};
    Frame frame{.focus = 40e-3 * along, .velocity = speed * along};
    std::mt19937 random(5);
    std::normal_distribution<double> normal(0.0, 1.0);
    for (std::ptrdiff_t i = 0; i < domain.nx; ++i)
        for (std::ptrdiff_t j = 0; j < domain.ny; ++j) {
            const Vec2 p = Vec2{domain.x_m(i), domain.y_m(j)} - frame.focus;
            const double xi = -dot(p, along);
            const double eta = std::abs(along.x * p.y - along.y * p.x);
            // Distance outside the front; the front starts 1 mm ahead of the focus.
            const double s = (eta * std::cos(angle_deg * degrees) -
                              (xi + 1e-3) * std::sin(angle_deg * degrees)) /
                             2e-3;
            double u = 0.0;
            if (xi > 0.0)
                u = (std::exp(-s * s) - 0.3 * std::exp(-(s - 2.5) * (s - 2.5)) +
                     (s < 0.0 ? 0.2 * (1.0 - std::exp(-s * s)) : 0.0)) /
                    (1.0 + xi / 50e-3);
            frame.u.push_back(1e-6 * (u + noise * normal(random)));
        }
    return frame;
}

TEST_CASE("the half-angle of a straight wake is found in any direction", "[mach_angle]") {
    const double speed = GENERATE(7.0, 8.0, 10.0);
    const double direction = GENERATE(0.0, 27.0, 90.0, 180.0, -135.0);
    const double angle = measures::mach_angle_theory_deg(rayleigh, speed);
    const measures::MachFit fit = wedge(angle, speed, direction).fit();
    CHECK(fit.reason == "");
    // The slope behind the front shifts its crest along with the growing distance: below 0.2.
    CHECK(fit.angle_deg == Approx(angle).margin(0.2));
    CHECK(fit.residual_deg < 0.5);
    CHECK(fit.points >= 16);
}

TEST_CASE("the angle that is found is the wake's, not the theory's", "[mach_angle]") {
    const double off = GENERATE(-4.0, -2.0, 2.0);
    CHECK(wedge(43.0 + off, 7.0, 0.0).fit().angle_deg == Approx(43.0 + off).margin(0.2));
}

TEST_CASE("noise of a tenth of the wake hardly turns the angle", "[mach_angle]") {
    const measures::MachFit fit = wedge(43.0, 7.0, 12.0, 0.1).fit();
    CHECK(fit.reason == "");
    // Crests of width 2 mm scatter by 0.2 mm over 33 mm, 40 on each side: 0.1 degrees.
    CHECK(fit.angle_deg == Approx(43.0).margin(0.5));
}

TEST_CASE("where there is no wake there is a reason and no angle", "[mach_angle]") {
    const Frame good = wedge(43.0, 7.0, 0.0);
    const auto refused = [](const measures::MachFit& fit, const std::string& why) {
        CHECK_FALSE(fit.valid());
        CHECK(std::isnan(fit.angle_deg));
        CHECK_THAT(fit.reason, Catch::Contains(why));
    };
    Frame resting = good;
    resting.velocity = {};
    refused(resting.fit(), "does not move");
    refused(good.fit(7.5), "not faster than the Rayleigh wave");
    refused(good.fit(rayleigh, 3e-3), "too short");
    Frame flat = good;
    std::fill(flat.u.begin(), flat.u.end(), 0.0);
    refused(flat.fit(), "outside the measured region");
    Frame noise = good;
    std::mt19937 random(6);
    std::normal_distribution<double> normal(0.0, 1e-9);
    for (double& u : noise.u)
        u = normal(random);
    refused(noise.fit(), "no Mach cone can be identified");
    Frame aside = good;
    aside.focus = {-80e-3, 0.0}; // its wake lies in the sponge
    refused(aside.fit(), "outside the measured region");
    Frame broken = good;
    std::fill(broken.u.begin(), broken.u.end(), std::nan(""));
    refused(broken.fit(), "outside the measured region");
}

TEST_CASE("the theoretical half-angle needs a supersonic focus", "[mach_angle]") {
    CHECK(measures::mach_angle_theory_deg(5.0, 10.0) == Approx(30.0).epsilon(1e-14));
    CHECK(std::isnan(measures::mach_angle_theory_deg(5.0, 5.0)));
    CHECK(std::isnan(measures::mach_angle_theory_deg(5.0, 0.0)));
}

TEST_CASE("a bent front gives no angle", "[mach_angle]") {
    // Half of one wedge, and of another 12 degrees wider from 25 mm behind the focus on.
    Frame bent = wedge(37.0, 7.0, 0.0);
    const Frame wide = wedge(49.0, 7.0, 0.0);
    for (std::ptrdiff_t i = 0; i < domain.nx; ++i)
        if (domain.x_m(i) < bent.focus.x - 25e-3)
            std::copy_n(wide.u.begin() + i * domain.ny, domain.ny, bent.u.begin() + i * domain.ny);
    CHECK_FALSE(bent.fit().valid());
    CHECK(std::isnan(bent.fit().angle_deg));
}

} // namespace test_mach_angle
