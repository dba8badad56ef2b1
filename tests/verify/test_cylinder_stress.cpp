// SPDX-License-Identifier: BSD-3-Clause
// The stress around rigid cylinders in engine "spectral" compared with closed forms, at real
// exponential growth e^{st}.
#include "support/rigid_cylinder.hpp"

#include <array>
#include <catch2/catch.hpp>

namespace test_cylinder_stress {

using namespace shearwake;
using namespace shearwake::test;

/// lambda/mu of the tissue around the cylinder.
const double lambda_per_mu = std::pow(1500.0 / 5.0, 2) - 2.0;

/// Displacement (across, down) and pressure in units of the radius and mu.
struct Flow {
    double across, down, p;
};

/// A motion of an incompressible solid around a cylinder of radius 1 at growth kappa: the sum over
/// n of the stream functions and the pressures
///     psi = k_n K_n(kappa r) T_n,   p = c_n r^-n T_n',
/// with T_n = cos(n theta) or sin(n theta) and its derivative T_n', for the angle theta from the
/// horizontal to the vertical direction down. The displacement is
///     u_r = (d psi/d theta)/r - (dp/dr)/kappa^2,   u_theta = -d psi/dr - (dp/d theta)/(r kappa^2).
class Series {
public:
    struct Term {
        int n;
        bool is_sine; // T_n
        double k, c;
    };
    Series(double kappa, std::vector<Term> terms) : kappa_(kappa), terms_(std::move(terms)) {}

    Flow at(double across, double down) const {
        const double r = std::hypot(across, down), theta = std::atan2(down, across);
        double u_r = 0.0, u_theta = 0.0, p = 0.0;
        for (const Term& t : terms_) {
            const double cosine = std::cos(t.n * theta), sine = std::sin(t.n * theta);
            const double shape = t.is_sine ? sine : cosine;
            const double slope = t.n * (t.is_sine ? cosine : -sine);
            const double x = kappa_ * r, decay = std::pow(r, -t.n);
            const double of_psi = t.k * bessel_k(t.n, x);
            const double of_slope = // psi'/kappa
                -t.k * bessel_k(t.n > 0 ? t.n - 1 : 1, x) - t.n / x * of_psi;
            p += t.c * decay * slope;
            u_r += slope * (of_psi + t.n * t.c * decay / (kappa_ * kappa_)) / r;
            // The second derivative of T_n is -n^2 T_n.
            u_theta +=
                shape * (-kappa_ * of_slope + t.n * t.n * t.c * decay / (kappa_ * kappa_ * r));
        }
        const double c = std::cos(theta), s = std::sin(theta);
        return {u_r * c - u_theta * s, u_r * s + u_theta * c, p};
    }
    double sigma_zz(double across, double down) const { // in units of mu
        constexpr double e = 1e-4;                      // error 1e-8
        return -at(across, down).p + (at(across, down + e).down - at(across, down - e).down) / e;
    }

private:
    double kappa_;
    std::vector<Term> terms_;
};

/// The cylinder moves across (u = 1) or down.
static Series moving(double kappa, bool is_down) {
    const double k = 2.0 / (kappa * bessel_k(0, kappa)); // see Series with u = e at r = 1
    const double c = kappa * kappa * (1.0 + k * bessel_k(1, kappa));
    if (is_down) return {kappa, {{1, false, k, -c}}};
    return {kappa, {{1, true, -k, c}}};
}
/// It turns by 1.
static Series turning(double kappa) {
    return {kappa, {{0, false, 1.0 / (kappa * bessel_k(1, kappa)), 0.0}}};
}
/// What it scatters of the shear wave e^{kappa x} along the horizontal (polarised down) or the
/// vertical direction (polarised across), if it is at rest. The wave has psi = -+e^{kappa x}/kappa,
/// and e^{kappa r cos theta} is the sum of e_n I_n cos(n theta), e_n = 2 - [n = 0].
static Series scattered(double kappa, bool is_level) {
    std::vector<Series::Term> terms;
    for (int n = 0; n < 12; ++n) {
        const double of_wave = (n > 0 ? 2.0 : 1.0) / kappa;
        const double ratio = n > 0 ? bessel_i(n - 1, kappa) / bessel_k(n - 1, kappa)
                                   : bessel_i(1, kappa) / bessel_k(1, kappa);
        const double at_1 = bessel_i(n, kappa) + ratio * bessel_k(n, kappa);
        const double c = n > 0 ? -kappa * kappa * at_1 / n : 0.0;
        if (is_level) {
            terms.push_back({n, false, -of_wave * ratio, -of_wave * c});
            continue;
        }
        // cos(n (theta - pi/2)) is a cosine for even n and a sine for odd n.
        const double sign = (n / 2) % 2 == 0 ? 1.0 : -1.0;
        terms.push_back({n, n % 2 == 1, sign * of_wave * ratio, sign * of_wave * c});
    }
    return {kappa, terms};
}

struct Errors {
    std::array<double, 4> from_surface{}; // at .4 to 1, 1 to 1.5, 1.5 to 2.5 and 2.5 to 5 spacings
    double largest = 0.0;
};

static Errors errors(RigidCylinder& cylinder, const Eigen::VectorXd& forces, const Series& exact) {
    const double h_m = cylinder.spacing_m();
    std::vector<double> downs_m;
    for (double down = -body_radius_m / h_m - 5.0; down < body_radius_m / h_m + 5.0; down += 0.7)
        downs_m.push_back(down * h_m);
    double mean = 0.0; // see the sphere: the base carries the force
    for (Eigen::Index i = spectral::down; i < forces.size(); i += spectral::marker_components)
        mean += 0.5 * forces[i] / (cylinder.width_m() * solid_mu_Pa);
    Errors e;
    for (const auto& [across_m, down_m, sigma_zz_Pa] : cylinder.stress(forces, downs_m)) {
        const double spacings = (std::hypot(across_m, down_m) - body_radius_m) / h_m;
        if (spacings < 0.4 || spacings > 5.0) continue;
        const double of_exact = exact.sigma_zz(across_m / body_radius_m, down_m / body_radius_m);
        e.largest = std::max(e.largest, std::abs(of_exact));
        double& worst = e.from_surface[spacings < 1.0   ? 0
                                       : spacings < 1.5 ? 1
                                       : spacings < 2.5 ? 2
                                                        : 3];
        worst = std::max(worst, std::abs(sigma_zz_Pa / solid_mu_Pa + mean - of_exact));
    }
    for (double& worst : e.from_surface)
        worst /= e.largest;
    return e;
}

static void check(const Errors& found, const std::array<double, 4>& limits) {
    for (std::size_t distance = 0; distance < limits.size(); ++distance) {
        CAPTURE(distance, found.from_surface[distance]);
        CHECK(found.from_surface[distance] > 0.0); // there are points
        CHECK(found.from_surface[distance] < limits[distance]);
    }
}

TEST_CASE("stress around a rigid cylinder has the stated errors", "[verify]") {
    const double kappa = GENERATE(from_range(
        test::parameters(1, std::vector{2.0, 1.0}))); // at 3 mm and 5 m/s: 270 and 530 Hz
    const double per_radius = GENERATE(6.0, 12.0);
    // In a domain of 20 radii the periodic images change the stress by up to 4 %.
    RigidCylinder cylinder(per_radius, kappa, 40.0, lambda_per_mu);
    // The forces act at markers and not on a surface, which causes errors of up to 21, 16, 9 and 8
    // %.
    const std::array<double, 4> limits = {0.215, 0.165, 0.095, 0.085};
    const auto of = [&](const auto& motion) {
        return cylinder.forces([&](double across_m, double down_m) {
            return body_radius_m * motion(across_m / body_radius_m, down_m / body_radius_m);
        });
    };
    CAPTURE(kappa, per_radius);
    SECTION("across") {
        check(errors(cylinder, of([](double, double) {
                         return Vec3{0.0, 1.0, 0.0};
                     }),
                     moving(kappa, false)),
              limits);
    }
    SECTION("down") {
        check(errors(cylinder, of([](double, double) {
                         return Vec3{0.0, 0.0, 1.0};
                     }),
                     moving(kappa, true)),
              limits);
    }
    SECTION("turning") {
        check(errors(cylinder, of([](double across, double down) {
                         return Vec3{0.0, -down, across};
                     }),
                     turning(kappa)),
              limits);
    }
    SECTION("in a horizontal wave") {
        // At the markers it is smoothed across the axis.
        const double more =
            std::exp(0.5 * std::pow(kappa * spectral::marker_smoothing / per_radius, 2));
        check(errors(cylinder, of([&](double across, double) {
                         return Vec3{0.0, 0.0, -more * std::exp(kappa * across)};
                     }),
                     scattered(kappa, true)),
              limits);
    }
    SECTION("in a vertical wave") {
        check(errors(cylinder, of([&](double, double down) {
                         return Vec3{0.0, -std::exp(kappa * down), 0.0};
                     }),
                     scattered(kappa, false)),
              limits);
    }
}

} // namespace test_cylinder_stress
