// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/transfer_table.hpp"

#include "base/error.hpp"
#include "engines/layered/load/load_spectrum.hpp"
#include "engines/layered/load/time_step.hpp"
#include "engines/layered/response/loss_tables.hpp"
#include "engines/layered/response/stack_response.hpp"
#include "support/cases.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>
#include <numbers>

namespace test_transfer_table {

using namespace shearwake;
using Complex = std::complex<double>;

TEST_CASE("relative interpolation error of the table in |k| is below 1e-6 everywhere",
          "[layered][slow]") {
    // |delta H| <= 1e-6 |H| at every (k, omega) of the grid limits the error of the field to 1e-6
    // for any load (Parseval). Media: a lossless half-space (sharp Rayleigh pole, branch point of
    // the head wave), one viscous layer, three layers with a stiff film, and a lossless plate whose
    // trapped modes are poles within eps / c of the axis.
    const int which = GENERATE(0, 1, 2, 3);
    Medium medium = test::half_space(test::tissue(1500.0, 0.0));
    if (which == 1 || which == 3) {
        medium.base = Base::rigid;
        medium.layers[0] = test::tissue(1500.0, which == 1 ? 1.0 : 0.0);
        medium.layers[0].thickness_m = 0.02;
    } else if (which == 2) {
        medium.layers.insert(medium.layers.begin(), medium.layers[0]);
        medium.layers[0].c_s_m_s = 36.5;
        medium.layers[0].thickness_m = 0.1e-3;
        medium.layers[1].loss = FractionalKelvinVoigt{260e-6, 0.27};
    }
    Case c = test::moving_focus(medium, ConstantSpeed{7.0});
    c.measure.depths_m = {0.0, 2e-3};
    const LayeredOptions options;
    const layered::TransferKey key{.medium = medium,
                                   .depths_m = c.measure.depths_m,
                                   .nx = 128,
                                   .ny = 96,
                                   .spacing_m = 0.75e-3,
                                   .time = layered::time_transform(c, options),
                                   .tolerance = options.interpolation_tolerance};
    const Comm alone = Comm::world().split(Comm::world().rank());
    layered::TransferTable table(key, 0, key.ny / 2 + 1, alone);

    // At the surface the error at every point is compared with H at this point. At depth H
    // decreases as e^{-k z} within a panel; there the error of the field of a 2 mm focus is
    // compared frequency by frequency.
    double worst = 0.0, worst_below = 0.0;
    const GaussianFootprint focus{2e-3};
    const double dk_x = 2.0 * std::numbers::pi / (128 * 0.75e-3);
    const double dk_y = 2.0 * std::numbers::pi / (96 * 0.75e-3);
    std::vector<Complex> exact(2);
    for (std::ptrdiff_t m = 0; m < table.frequencies(); m += 7) {
        const layered::StackResponse response(medium, key.time.omega(m), key.depths_m);
        double error2 = 0.0, field2 = 0.0;
        for (std::ptrdiff_t ky = 0; ky <= 48; ky += 3) {
            for (std::size_t depth = 0; depth < 2; ++depth) {
                const auto row = table.row(ky, depth);
                for (std::ptrdiff_t kx = 0; kx <= 64; ++kx) {
                    const double x = static_cast<double>(kx) * dk_x;
                    const double y = static_cast<double>(ky) * dk_y;
                    response.evaluate(std::hypot(x, y), exact);
                    const Complex h = row[static_cast<std::size_t>(kx * table.frequencies() + m)];
                    const double error = std::abs(h - exact[depth]), size = std::abs(exact[depth]);
                    if (depth == 0) {
                        worst = test::worse(worst, error / size);
                    } else {
                        const double g = spectrum(focus, x, y);
                        error2 += g * g * error * error;
                        field2 += g * g * size * size;
                    }
                }
            }
        }
        worst_below = test::worse(worst_below, std::sqrt(error2 / field2));
    }
    CAPTURE(which, worst, worst_below);
    CHECK(worst < 1e-6);       // required
    CHECK(worst_below < 1e-6); // required
}

TEST_CASE("packing and unpacking a radial interpolant preserves its values", "[layered]") {
    const auto f = [](double k, std::span<Complex> out) {
        out[0] = 1.0 / Complex(k - 3.0, 0.01);
        out[1] = std::exp(-k);
    };
    const auto fitted = layered::RadialInterpolant::fit(f, 2, 10.0, 1e-10);
    const auto packed = fitted.packed();
    const auto back = layered::RadialInterpolant::unpacked(packed, 2);
    const std::vector<double> k = {0.0, 1.0, 2.99, 3.0, 3.01, 9.0, 10.0};
    for (std::size_t component = 0; component < 2; ++component) {
        std::vector<Complex> before(k.size()), after(k.size()), exact(2);
        fitted.evaluate(component, k, before.data(), 1);
        back.evaluate(component, k, after.data(), 1);
        CHECK(before == after);
        for (std::size_t i = 0; i < k.size(); ++i) {
            f(k[i], exact);
            // Relative to the peak, 1/0.01.
            CHECK(std::abs(before[i] - exact[component]) < 1e-8 * 100.0);
        }
    }
}

TEST_CASE("rejects a function with a pole on the axis", "[layered]") {
    const auto f = [](double k, std::span<Complex> out) { out[0] = 1.0 / (k - 1.0); };
    CHECK_THROWS_AS(layered::RadialInterpolant::fit(f, 1, 3.0, 1e-9), CaseFailure);
}

TEST_CASE("approximates a kink on the axis by panels whose error is negligible", "[layered]") {
    const auto f = [](double k, std::span<Complex> out) { out[0] = std::sqrt(std::abs(k - 1.0)); };
    const auto fitted = layered::RadialInterpolant::fit(f, 1, 3.0, 1e-9);
    const std::vector<double> k = {0.5, 1.0 - 1e-6, 1.0, 1.0 + 1e-6, 2.0};
    std::vector<Complex> values(k.size());
    fitted.evaluate(0, k, values.data(), 1);
    for (std::size_t i = 0; i < k.size(); ++i) // sqrt(1e-13) at the kink, the narrowest panel
        CHECK(std::abs(values[i] - std::sqrt(std::abs(k[i] - 1.0))) < 1e-6);
}

TEST_CASE("resolves waves that hardly decay up to rounding", "[layered]") {
    // A half-space and a layer whose loss factors are 1e-9, a half-space whose branch point k_p is
    // within 1e-10 k_p of the axis, and a film of 20 um on a rigid base, whose H is the difference
    // of large numbers.
    struct Example {
        Layer layer;
        Base base;
        double frequency_Hz, spacing_m;
    };
    Layer weak = test::tissue(1500.0, 1e-9 * 25e3 / (2.0 * std::numbers::pi * 100.0));
    Layer plate = weak, slow = test::tissue(866.0), film = test::tissue(573.0);
    plate.thickness_m = 0.02;
    slow.c_s_m_s = 2.2;
    slow.loss = KelvinVoigt{1e-5};
    film.c_s_m_s = 0.9;
    film.thickness_m = 2e-5;
    const Example examples[] = {{weak, Base::half_space, 100.0, 1e-3},
                                {plate, Base::rigid, 100.0, 1e-3},
                                {slow, Base::half_space, 2700.0, 3e-3},
                                {film, Base::rigid, 2.5, 5e-3}};
    for (const Example& example : examples) {
        const Medium medium{{example.layer}, example.base};
        CAPTURE(medium.layers[0].c_s_m_s, medium.layers[0].thickness_m);
        const std::vector<double> surface = {0.0};
        const layered::StackResponse response(medium, 2.0 * std::numbers::pi * example.frequency_Hz,
                                              surface);
        const auto h = [&](double k, std::span<Complex> out) { response.evaluate(k, out); };
        const double k_max = std::numbers::pi / example.spacing_m;
        const auto fitted = layered::RadialInterpolant::fit(h, 1, k_max, 1e-9);
        CHECK(fitted.panels() < 2000);
        CHECK_NOTHROW(layered::fit_loss(response, example.spacing_m, 1e-8));
        // Away from the poles rounding is small.
        for (const double k : {0.31 * k_max, 0.83 * k_max}) {
            Complex exact, value;
            h(k, {&exact, 1});
            fitted.evaluate(0, std::span(&k, 1), &value, 1);
            CHECK(std::abs(value - exact) < 1e-6 * std::abs(exact));
        }
    }
}

TEST_CASE("a steady state without loss and responses that overflow are errors of the case",
          "[layered]") {
    Case c = test::moving_focus(test::half_space(test::tissue(1500.0, 1e-8)), ConstantSpeed{7.0});
    const auto remark_of = [&] {
        const auto remarks = engines::make_engine(LayeredOptions{})->limits(c);
        return remarks.empty() ? std::string() : remarks.back().key + ": " + remarks.back().message;
    };
    CHECK(remark_of().empty()); // the transient is computed at complex frequencies
    c.time.regime = Regime::periodic;
    c.domain.edges = DomainEdges::open;
    // omega viscosity / mu = 2 pi 71.4 Hz 1e-8 Pa s / 25 kPa
    CHECK_THAT(remark_of(), Catch::Contains("time.regime") &&
                                Catch::Contains("layer \"tissue\" at 71.43 Hz is 1.8e-10"));
    c.scene.medium.layers[0].loss = KelvinVoigt{1e-6};
    CHECK(remark_of().empty());
    c.scene.medium.layers[0].density_kg_m3 = 1e300;
    CHECK_THAT(remark_of(), Catch::Contains("medium.layer") && Catch::Contains("layer \"tissue\""));
}

} // namespace test_transfer_table
