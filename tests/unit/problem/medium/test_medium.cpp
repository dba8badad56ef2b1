// SPDX-License-Identifier: BSD-3-Clause
#include "problem/medium/material_field.hpp"

#include <catch2/catch.hpp>

#include <cmath>

namespace test_medium {

using namespace shearwake;

static Medium two_layers(Base base = Base::rigid) {
    return {.layers = {{.thickness_m = 2e-3, .c_p_m_s = 60.0, .c_s_m_s = 6.0},
                       {.thickness_m = 8e-3, .c_p_m_s = 50.0, .c_s_m_s = 2.0}},
            .base = base};
}

/// 11 x 1 x 11 points from -10 to 10 mm along x, the same all along y, 0 to 10 mm deep: c_s rises
/// with both, from 5 m/s by 1 m/s a point.
static std::shared_ptr<const MaterialMap> rising_map() {
    MaterialMap map{
        .counts = {11, 1, 11}, .origin_m = {-10e-3, 0, 0}, .spacing_m = {2e-3, 0, 1e-3}};
    for (int i = 0; i < 11; ++i)
        for (int k = 0; k < 11; ++k)
            map.c_s_m_s.push_back(5.0 + i + k);
    map.content_hash = hash_of(map);
    return std::make_shared<const MaterialMap>(map);
}

TEST_CASE("the bulk modulus is positive above 2 / sqrt 3", "[bulk_modulus]") {
    CHECK(least_speed_ratio == Approx(2.0 / std::sqrt(3.0)).epsilon(1e-15));
    CHECK(has_positive_bulk_modulus({1.1548, 1.0}));
    CHECK_FALSE(has_positive_bulk_modulus({1.1547, 1.0}));
}

TEST_CASE("layers follow each other downward", "[bulk_modulus]") {
    CHECK(depths(two_layers(), 0).bottom_m == 2e-3);
    CHECK(depths(two_layers(), 1).top_m == 2e-3);
    CHECK(depths(two_layers(), 1).bottom_m == 10e-3);
    CHECK(std::isinf(depths(two_layers(Base::half_space), 1).bottom_m));
}

TEST_CASE("without a map the speeds are the layer's and the body's", "[bulk_modulus]") {
    const Medium medium = two_layers();
    CHECK(softest_against_pressure(medium, 1) == Speeds{50.0, 2.0});
    const Body body{.shape = Box{{1.0, 1.0, 1.0}}, .c_s_m_s = 40.0};
    CHECK(softest_against_pressure(medium, 0, &body) == Speeds{60.0, 40.0});
}

TEST_CASE("the stiffest point of a map in the layer counts", "[bulk_modulus]") {
    Medium medium = two_layers();
    medium.map = rising_map();
    // Down to 2 mm: k = 2, the last point along x.
    CHECK(softest_against_pressure(medium, 0) == Speeds{60.0, 17.0});
    CHECK(softest_against_pressure(medium, 1) == Speeds{50.0, 25.0});
}

TEST_CASE("only the map's points at the body count for the body", "[bulk_modulus]") {
    Medium medium = two_layers();
    medium.map = rising_map();
    // From -5 to -1 mm and 4 to 6 mm deep: up to the points at 0 mm (i = 5) and 6 mm (k = 6).
    const Body body{
        .shape = Box{{4e-3, 4e-3, 2e-3}}, .centre_m = {-3e-3, 0, 5e-3}, .c_p_m_s = 30.0};
    CHECK(softest_against_pressure(medium, 1, &body) == Speeds{30.0, 16.0});
    // Nothing of the map is left where the body gives both; beyond the map it is in the layer.
    Body whole = body, away = body;
    whole.c_s_m_s = 3.0;
    away.centre_m.x = 50e-3;
    CHECK(softest_against_pressure(medium, 1, &whole) == Speeds{30.0, 3.0});
    CHECK(softest_against_pressure(medium, 1, &away) == Speeds{30.0, 2.0});
}

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
