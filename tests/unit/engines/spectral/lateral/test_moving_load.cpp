// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/moving_load.hpp"
#include "problem/load/load.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

namespace test_moving_load {

using namespace shearwake;

using Complex = std::complex<double>;

constexpr double step_s = 30e-6;

/// The load at the first kx, without footprint and area.
static Complex load_at(const Case& c, double kx, double t_s) {
    return strength(c.scene.load, t_s) *
           std::polar(1.0, -kx * (focus_m(c.scene.load, t_s).x - c.domain.x_m(0)));
}

/// Its average around step n, with weights that fall linearly to zero within a step: by the
/// midpoint rule, in error by 1e-5 at a jump.
static Complex average(const Case& c, double kx, std::ptrdiff_t n) {
    constexpr int points = 40'000;
    Complex sum = 0.0;
    for (int i = 0; i < points; ++i) {
        const double s = (i + 0.5) / points * (n == 0 ? 1.0 : 2.0) - (n == 0 ? 0.0 : 1.0);
        sum += (1.0 - std::abs(s)) * load_at(c, kx, (static_cast<double>(n) + s) * step_s);
    }
    return 2.0 / points * sum;
}

TEST_CASE("the load of a step is its average around it, also where the load jumps", "[spectral]") {
    Case c = test::moving_focus(test::half_space(test::tissue()), ConstantSpeed{5.0});
    c.domain = {32, 24, 1e-3, 0.0};
    auto& travel = test::travel_of(c);
    SECTION("a path that ends at a step") {
        travel.path = {{0.0, 0.0}, {10 * 5.0 * step_s, 0.0}};
    }
    SECTION("a path that ends between two steps") {
        travel.path = {{0.0, 0.0}, {10.3 * 5.0 * step_s, 0.0}};
    }
    SECTION("a path that repeats") {
        travel.path = {{0.0, 0.0}, {4.6 * 5.0 * step_s, 0.0}};
        travel.at_end = AtEnd::repeat;
    }
    SECTION("a path that turns") {
        travel.path = {{0.0, 0.0}, {4.6 * 5.0 * step_s, 0.0}};
        travel.at_end = AtEnd::back_and_forth;
    }
    fft::SlabShare share;
    share.ky_count = 1;
    const spectral::WaveVectors vectors(c.domain, share);
    spectral::MovingLoad load(c, vectors, step_s,
                              {c.scene.load, c.time.duration_s() + 2.0 * step_s});
    fft::AlignedVector<Block> of_step(spectral::parts);
    const double kx = vectors.kx_rad_m(1);
    const double unit =
        spectrum(c.scene.load.footprint, kx, 0.0) / (c.domain.extent_x_m() * c.domain.extent_y_m());
    for (std::ptrdiff_t n = 0; n < 16; ++n) {
        load.sample(n);
        load.put(0, 0, of_step.data());
        const Complex found(of_step[spectral::plus_re][1], of_step[spectral::plus_im][1]);
        CAPTURE(n);
        // Three samples are in error by 1/24 at a jump.
        CHECK(std::abs(found / unit - average(c, kx, n)) < 1e-4);
    }
}

} // namespace test_moving_load
