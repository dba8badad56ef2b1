// SPDX-License-Identifier: BSD-3-Clause
#include "problem/case/edges.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace test_edge_absorption {

using namespace shearwake;

TEST_CASE("the drag of a sponge is 0 outside the sponge", "[edge_absorption]") {
    CHECK(edge_drag_Hz(10e-3, 10e-3, 5.0) == 0.0);
    CHECK(edge_drag_Hz(11e-3, 10e-3, 5.0) == 0.0);
    CHECK(edge_drag_Hz(0.0, 10e-3, 5.0) == Approx(7.3 * 500.0));
    CHECK(edge_drag_Hz(2e-3, 10e-3, 5.0) > edge_drag_Hz(3e-3, 10e-3, 5.0));
}

TEST_CASE("the transmission of short waves through a sponge follows from the integral of the drag",
          "[edge_absorption]") {
    // e^{-2 integral of gamma/(2c)}, energy, over both sponges: e^{-2 7.3 / 2.5}. The
    // reflected energy and the next order of gamma/omega are 2 % of this value at a tenth of the
    // width (observed).
    CHECK(returned_energy(1e-3, 10e-3) == Approx(std::exp(-14.6 / 2.5)).epsilon(0.05));
}

TEST_CASE("the energy that a sponge returns increases with the wavelength", "[edge_absorption]") {
    CHECK(returned_energy(10e-3, 10e-3) < 0.005);
    CHECK(returned_energy(16e-3, 10e-3) < 0.01); // documented: 1 % at 1.65 widths
    CHECK(returned_energy(17e-3, 10e-3) > 0.01);
    // To endless waves the drags of both sponges are one damper of 2 7.3/2.5 impedances.
    const double damper = 14.6 / 2.5;
    CHECK(returned_energy(10.0, 10e-3) ==
          Approx((damper * damper + 4.0) / std::pow(2.0 + damper, 2)).epsilon(0.01));
    CHECK(returned_energy(34e-3, 20e-3) == Approx(returned_energy(17e-3, 10e-3)));
}

TEST_CASE("the design speed of the edges is that of the layers down to a depth",
          "[edge_absorption]") {
    Layer soft{.thickness_m = 5e-3, .density_kg_m3 = 1000.0, .c_p_m_s = 1500.0, .c_s_m_s = 3.0};
    Layer stiff = soft;
    stiff.c_s_m_s = 6.0;
    Medium medium{{soft, stiff}, Base::rigid};
    CHECK(edge_speed_m_s(medium, 5e-3) == Approx(3.0));
    CHECK(edge_speed_m_s(medium, 10e-3) == Approx(std::sqrt(22.5)));
    CHECK(edge_speed_m_s(medium, 1.0) ==
          Approx(std::sqrt(22.5))); // at most the depth of the medium
    medium.base = Base::half_space;
    medium.layers[1].thickness_m = 0.0;
    CHECK(edge_speed_m_s(medium, 20e-3) == Approx(std::sqrt(0.25 * 9.0 + 0.75 * 36.0)));
}

TEST_CASE("the longest wave is that of the footprint or of the modulation", "[edge_absorption]") {
    Load load;
    load.footprint = GaussianFootprint{3e-3};
    // e^{-k^2 sigma^2/2} = 1/2 at k = 0.924/mm; three times that wavelength
    CHECK(longest_wave_m(load, 5.0) == Approx(20.4e-3).epsilon(1e-3));
    load.modulation.envelope = {{SineGain{200.0}}};
    CHECK(longest_wave_m(load, 5.0) == Approx(25e-3));
    load.modulation.envelope = {{SineGain{2000.0}}};
    CHECK(longest_wave_m(load, 5.0) == Approx(20.4e-3).epsilon(1e-3));
}

} // namespace test_edge_absorption
