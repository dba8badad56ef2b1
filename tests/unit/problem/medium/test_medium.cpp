// SPDX-License-Identifier: BSD-3-Clause
#include "problem/medium/medium.hpp"

#include <catch2/catch.hpp>

namespace test_medium {

using namespace shearwake;

TEST_CASE("the Rayleigh speed has the textbook ratios", "[medium]") {
    // nu = 0.25: c_R/c_s = sqrt(2 - 2/sqrt 3) exactly; nu -> 0.5: 0.9553 (four digits published).
    Layer layer{.density_kg_m3 = 1000.0, .c_p_m_s = 5.0 * std::sqrt(3.0), .c_s_m_s = 5.0};
    CHECK(rayleigh_speed_m_s(layer) / 5.0 ==
          Approx(std::sqrt(2.0 - 2.0 / std::sqrt(3.0))).epsilon(1e-12));
    layer.c_p_m_s = 1500.0;
    CHECK(rayleigh_speed_m_s(layer) / 5.0 == Approx(0.9553).margin(5e-5));
}

TEST_CASE("a film much thinner than the footprint does not carry the surface wave", "[medium]") {
    Medium medium{{Layer{.name = "film", .thickness_m = 0.1e-3},
                   Layer{.name = "dermis", .thickness_m = 2e-3}, Layer{.name = "fat"}},
                  Base::half_space};
    CHECK(surface_wave_layer(medium, 3e-3).name == "dermis");
    CHECK(surface_wave_layer(medium, 0.3e-3).name == "film");
    CHECK(surface_wave_layer(medium, 30e-3).name == "fat");
}

} // namespace test_medium
