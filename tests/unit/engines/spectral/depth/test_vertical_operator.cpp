// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/depth/vertical_operator.hpp"

#include "support/cases.hpp"

#include <catch2/catch.hpp>

namespace test_vertical_operator {

using namespace shearwake;

/// A polynomial in the height over the base, t = 1 - z/H.
struct Term {
    double factor;
    int power;
};
using Polynomial = std::vector<Term>;

struct Motion {
    Polynomial u, w, v;
};

double value(const Polynomial& f, double t) {
    double sum = 0.0;
    for (const Term& term : f)
        sum += term.factor * std::pow(t, term.power);
    return sum;
}

/// Integrals over the depth H_m of f g, f' g and f' g', where ' is the derivative by z.
struct Integrals {
    double H_m;

    double product(const Polynomial& f, const Polynomial& g) const {
        return sum(f, g, [&](int m, int n) { return H_m / (m + n + 1); });
    }
    double slope(const Polynomial& f, const Polynomial& g) const {
        return sum(f, g, [](int m, int n) { return -m / double(m + n); });
    }
    double slopes(const Polynomial& f, const Polynomial& g) const {
        return sum(f, g, [&](int m, int n) { return m * n / (H_m * (m + n - 1)); });
    }

private:
    template <class Integral>
    static double sum(const Polynomial& f, const Polynomial& g, Integral&& integral) {
        double total = 0.0;
        for (const Term& a : f)
            for (const Term& b : g)
                total += a.factor * b.factor * integral(a.power, b.power);
        return total;
    }
};

/// The bilinear form of VerticalOperator, integrated exactly.
double form(const Integrals& over, double lambda_Pa, double mu_Pa, double k, const Motion& a,
            const Motion& b) {
    const double dilation = over.slopes(a.w, b.w) - k * over.slope(a.w, b.u) -
                            k * over.slope(b.w, a.u) + k * k * over.product(a.u, b.u);
    const double stretch = k * k * over.product(a.u, b.u) + over.slopes(a.w, b.w);
    const double shear = over.slopes(a.u, b.u) + k * over.slope(a.u, b.w) +
                         k * over.slope(b.u, a.w) + k * k * over.product(a.w, b.w);
    const double horizontal = over.slopes(a.v, b.v) + k * k * over.product(a.v, b.v);
    return lambda_Pa * dilation + mu_Pa * (2.0 * stretch + shear + horizontal);
}

TEST_CASE("the internal force on polynomials is that of the exact integrals", "[spectral]") {
    Case c = test::moving_focus({}, ConstantSpeed{7.0});
    c.scene.medium.base = Base::rigid;
    Layer layer = test::tissue(60.0, 0.7);
    layer.thickness_m = 12e-3;
    c.scene.medium.layers = {layer};
    const spectral::DepthMesh mesh = spectral::choose_mesh(c, SpectralOptions{});
    REQUIRE(mesh.elements() > 1);
    const spectral::VerticalOperator vertical(mesh, spectral::background_of(mesh, c.scene.medium));
    const std::ptrdiff_t levels = vertical.levels(), parts = spectral::parts;
    const auto pencil_of = [&](const Motion& motion) {
        std::vector<Block> pencil(static_cast<std::size_t>(vertical.unknowns() * parts));
        for (std::ptrdiff_t level = 0; level < levels; ++level) {
            const double t = 1.0 - mesh.z_m(static_cast<std::size_t>(level)) / layer.thickness_m;
            for (std::ptrdiff_t part = 0; part < parts; ++part) {
                const auto at = [&](std::ptrdiff_t unknown) -> Block& {
                    return pencil[static_cast<std::size_t>(unknown * parts + part)];
                };
                const auto scale = static_cast<double>(part + 1);
                at(2 * level) = block_of(scale * value(motion.u, t));
                at(2 * level + 1) = block_of(scale * value(motion.w, t));
                at(2 * levels + level) = block_of(scale * value(motion.v, t));
            }
        }
        return pencil;
    };
    const Motion now = {{{1.0, 2}, {0.4, 3}}, {{-0.7, 1}, {0.9, 3}}, {{1.1, 1}, {-0.6, 4}}};
    const Motion before = {{{0.9, 2}, {0.5, 3}}, {{-0.8, 1}, {0.7, 3}}, {{1.3, 1}, {-0.5, 4}}};
    const Motion change = {{{0.1, 2}, {-0.1, 3}}, {{0.1, 1}, {0.2, 3}}, {{-0.2, 1}, {-0.1, 4}}};
    const double rate_1_s = 1.0 / 20e-6;
    Block k{};
    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
        k[lane] = 90.0 * static_cast<double>(lane);
    std::vector<Block> force(static_cast<std::size_t>(vertical.unknowns() * parts));
    vertical.add_internal_force(k, rate_1_s, pencil_of(now).data(), pencil_of(before).data(),
                                force.data());

    const double mu_Pa = 1000.0 * 25.0, lambda_Pa = 1000.0 * 3600.0 - 2.0 * mu_Pa;
    const Integrals over{layer.thickness_m};
    for (const Motion& test :
         {Motion{{{1.0, 2}}, {}, {}}, Motion{{}, {{1.0, 3}}, {}}, Motion{{}, {}, {{1.0, 2}}}}) {
        const std::vector<Block> tested = pencil_of(test);
        for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
            for (std::ptrdiff_t part = 0; part < parts; ++part) {
                double work = 0.0;
                for (auto i = static_cast<std::size_t>(part); i < force.size();
                     i += static_cast<std::size_t>(parts))
                    work += force[i][lane] * tested[i][lane];
                const double expected = form(over, lambda_Pa, mu_Pa, k[lane], now, test) +
                                        form(over, 0.0, 0.7 * rate_1_s, k[lane], change, test);
                const auto square = static_cast<double>((part + 1) * (part + 1));
                // Both factors are scaled by part + 1. The sums have some hundred terms.
                CHECK(work == Approx(-square * expected).epsilon(1e-11));
            }
    }
}

} // namespace test_vertical_operator
