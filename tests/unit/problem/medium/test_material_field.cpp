// SPDX-License-Identifier: BSD-3-Clause
#include "problem/medium/material_field.hpp"

#include "problem/case/case.hpp"

#include <catch2/catch.hpp>

namespace test_material_field {

using namespace shearwake;

static Medium two_layers() {
    return {.layers = {{.name = "skin",
                        .thickness_m = 2e-3,
                        .density_kg_m3 = 1100.0,
                        .c_p_m_s = 60.0,
                        .c_s_m_s = 6.0,
                        .loss = KelvinVoigt{2.0}},
                       {.name = "fat",
                        .thickness_m = 10e-3,
                        .density_kg_m3 = 950.0,
                        .c_p_m_s = 50.0,
                        .c_s_m_s = 2.0}}};
}

constexpr Vec3 cell_m{1e-3, 1e-3, 1e-3};

/// 4 x 3 x 5 points; c_s is linear in x, y and z, and nothing else is given.
static MaterialMap linear_map() {
    MaterialMap map{
        .counts = {4, 3, 5}, .origin_m = {-3e-3, -1e-3, 2e-3}, .spacing_m = {2e-3, 1e-3, 0.5e-3}};
    for (std::ptrdiff_t i = 0; i < 4; ++i)
        for (std::ptrdiff_t j = 0; j < 3; ++j)
            for (std::ptrdiff_t k = 0; k < 5; ++k)
                map.c_s_m_s.push_back(5.0 + 300.0 * (-3e-3 + 2e-3 * static_cast<double>(i)) -
                                      500.0 * (-1e-3 + 1e-3 * static_cast<double>(j)) +
                                      100.0 * (2e-3 + 0.5e-3 * static_cast<double>(k)));
    map.content_hash = hash_of(map);
    return map;
}

static double linear_c_s_m_s(Vec3 p) {
    return 5.0 + 300.0 * p.x - 500.0 * p.y + 100.0 * p.z;
}

TEST_CASE("the material of a layer follows from its speeds", "[material_field]") {
    const Medium medium = two_layers();
    CHECK(material_of(medium.layers[0]) ==
          Material{1100.0, 1100.0 * 60.0 * 60.0 - 2.0 * 1100.0 * 36.0, 1100.0 * 36.0, 2.0});
    CHECK(material_of(medium.layers[1]).viscosity_Pa_s == 0.0);
    CHECK(material_of_cell(medium, 0, {}, cell_m) == material_of(medium.layers[0]));
}

TEST_CASE("a cell at the face of a body is a laminate", "[material_field]") {
    Medium medium = two_layers();
    // Its face at z = 1.25 mm leaves it three quarters of the cell from 1 to 2 mm.
    medium.bodies = {{.shape = Box{{1.0, 1.0, 4e-3}},
                      .centre_m = {0, 0, 3.25e-3},
                      .c_s_m_s = 20.0,
                      .viscosity_Pa_s = 8.0}};
    const CellMaterial m = material_of_cell(medium, 0, {0, 0, 1.5e-3}, cell_m);
    const double body_mu = 1100.0 * 400.0, layer_mu = 1100.0 * 36.0, p = 1100.0 * 3600.0;
    CHECK(m.density_kg_m3 == Approx(1100.0).epsilon(1e-12)); // not given: the layer's
    // The self-consistent estimate, and the one with the viscous parts at growth s, of which the
    // layer has the larger one: 2 Pa s of 39.6 kPa.
    const double s = 0.25 * layer_mu / 2.0;
    const auto of = [](double mu, double mean) { return (mu - mean) / (mu + 1.5 * mean); };
    CHECK(0.25 * of(layer_mu, m.mu_Pa) + 0.75 * of(body_mu, m.mu_Pa) ==
          Approx(0.0).margin(1e-12)); // rounding
    const double grown = m.mu_Pa + s * m.viscosity_Pa_s;
    CHECK(0.25 * of(layer_mu + s * 2.0, grown) + 0.75 * of(body_mu + s * 8.0, grown) ==
          Approx(0.0).margin(1e-12));
    // Both have the same p-wave modulus, so that lambda is the mean.
    CHECK(m.lambda_Pa ==
          Approx(0.25 * (p - 2.0 * layer_mu) + 0.75 * (p - 2.0 * body_mu)).epsilon(1e-12));
    const double across = 1.0 / (0.25 / layer_mu + 0.75 / body_mu);
    CHECK(m.mu_across_Pa == Approx(across).epsilon(1e-12));
    CHECK(across + s * m.viscosity_across_Pa_s ==
          Approx(1.0 / (0.25 / (layer_mu + s * 2.0) + 0.75 / (body_mu + s * 8.0))).epsilon(1e-12));
    CHECK(std::abs(m.normal.z) == Approx(1.0).epsilon(1e-12));
    CHECK_FALSE(material_of_cell(medium, 0, {0, 0, 0.5e-3}, cell_m).is_laminate());
    medium.bodies[0].viscosity_Pa_s.reset(); // not given: the layer's
    CHECK(material_of_cell(medium, 0, {0, 0, 1.5e-3}, cell_m).viscosity_Pa_s ==
          Approx(2.0).epsilon(1e-15));
    // A uniform viscosity remains uniform along the surface.
    medium.bodies[0].viscosity_Pa_s = 2.0;
    CHECK(material_of_cell(medium, 0, {0, 0, 1.5e-3}, cell_m).viscosity_Pa_s ==
          Approx(2.0).epsilon(1e-15));
    medium.bodies[0].c_s_m_s = 2.0; // softer
    medium.bodies[0].viscosity_Pa_s = 8.0;
    const CellMaterial soft = material_of_cell(medium, 0, {0, 0, 1.5e-3}, cell_m);
    CHECK(soft.mu_Pa == Approx(0.25 * layer_mu + 0.75 * 1100.0 * 4.0).epsilon(1e-12));
    CHECK(soft.viscosity_Pa_s == Approx(0.25 * 2.0 + 0.75 * 8.0).epsilon(1e-12));
    // In the other layer it keeps that layer's density.
    CHECK(material_of_cell(medium, 1, {0, 0, 3e-3}, cell_m).density_kg_m3 == 950.0);
}

TEST_CASE("a later body replaces an earlier one", "[material_field]") {
    Medium medium = two_layers();
    const Box large{{1.0, 1.0, 1.0}};
    medium.bodies = {{.shape = large, .c_s_m_s = 20.0}, {.shape = large, .density_kg_m3 = 1900.0}};
    const Material m = material_of_cell(medium, 1, {0, 0, 5e-3}, cell_m);
    CHECK(m.density_kg_m3 == 1900.0);
    CHECK(m.mu_Pa == 1900.0 * 4.0); // the layer's c_s, not the other body's
}

TEST_CASE("a map is exact for a linear function between its points", "[material_field]") {
    const MaterialMap map = linear_map();
    const Vec3 p = GENERATE(Vec3{0.3e-3, 0.4e-3, 2.9e-3}, Vec3{-3e-3, -1e-3, 2e-3},
                            Vec3{3e-3, 1e-3, 4e-3}, Vec3{2.9e-3, -0.9e-3, 3.99e-3});
    // Seven roundings of numbers near 5.
    CHECK(sample(map, p).c_s_m_s.value() == Approx(linear_c_s_m_s(p)).epsilon(1e-14));
    CHECK_FALSE(sample(map, p).c_p_m_s.has_value());
}

TEST_CASE("outside its boundary a map continues its nearest value for half a spacing",
          "[material_field]") {
    const MaterialMap map = linear_map();
    CHECK(sample(map, {-3.9e-3, 0, 3e-3}).c_s_m_s.value() ==
          Approx(linear_c_s_m_s({-3e-3, 0, 3e-3})).epsilon(1e-14));
    CHECK(sample(map, {0, 0, 4.2e-3}).c_s_m_s.value() ==
          Approx(linear_c_s_m_s({0, 0, 4e-3})).epsilon(1e-14));
    CHECK_FALSE(sample(map, {-4.1e-3, 0, 3e-3}).c_s_m_s.has_value());
    CHECK_FALSE(sample(map, {0, 1.6e-3, 3e-3}).c_s_m_s.has_value());
    CHECK_FALSE(sample(map, {0, 0, 1.7e-3}).c_s_m_s.has_value());
}

TEST_CASE("a map with a single point and no spacing is unbounded", "[material_field]") {
    MaterialMap map{.counts = {2, 1, 1}, .origin_m = {0, 9, 9}, .spacing_m = {1.0, 0, 0}};
    map.density_kg_m3 = {1.0, 3.0};
    CHECK(sample(map, {0.5, -7.0, 1e3}).density_kg_m3.value() == 2.0);
    CHECK_FALSE(sample(map, {1.6, -7.0, 1e3}).density_kg_m3.has_value());
}

TEST_CASE("a map replaces the layer and is replaced by bodies", "[material_field]") {
    Medium medium = two_layers();
    medium.map = std::make_shared<const MaterialMap>(linear_map());
    const Vec3 p{1e-3, 0, 3e-3};
    CHECK(material_of_cell(medium, 1, p, cell_m).mu_Pa ==
          Approx(950.0 * std::pow(linear_c_s_m_s(p), 2)).epsilon(1e-12));
    CHECK(material_of_cell(medium, 1, {0, 0, 9e-3}, cell_m) == material_of(medium.layers[1]));
    medium.bodies = {{.shape = Box{{1.0, 1.0, 1.0}}, .density_kg_m3 = 1900.0}};
    CHECK(material_of_cell(medium, 1, p, cell_m).mu_Pa ==
          Approx(1900.0 * std::pow(linear_c_s_m_s(p), 2)).epsilon(1e-12));
}

TEST_CASE("a cell between different points of a map is a laminate", "[material_field]") {
    Medium medium = two_layers();
    MaterialMap map{.counts = {2, 1, 1}, .origin_m = {-0.5e-3, 0, 0}, .spacing_m = {1e-3, 0, 0}};
    map.c_s_m_s = {2.0, GENERATE(1.0, 2.1, 8.0)}; // that of the layer and another one
    map.viscosity_Pa_s = {0.0, map.c_s_m_s[1] == 2.1 ? 0.0 : 3.0};
    medium.map = std::make_shared<const MaterialMap>(map);
    const Vec3 middle{0.0, 0.0, 5e-3};
    const CellMaterial m = material_of_cell(medium, 1, middle, cell_m);
    if (map.c_s_m_s[1] == 2.1) { // no interface
        CHECK_FALSE(m.is_laminate());
        CHECK(m.mu_Pa == Approx(950.0 * 2.05 * 2.05).epsilon(1e-12));
        return;
    }
    // The same as half a cell of a body.
    Medium body = two_layers();
    body.bodies = {{.shape = Box{{2.0, 1.0, 1.0}},
                    .centre_m = {1.0, 0.0, 0.0},
                    .c_s_m_s = map.c_s_m_s[1],
                    .viscosity_Pa_s = 3.0}};
    const CellMaterial same = material_of_cell(body, 1, middle, cell_m);
    CHECK(m.mu_Pa == Approx(same.mu_Pa).epsilon(1e-6));
    CHECK(m.mu_across_Pa == Approx(same.mu_across_Pa).epsilon(1e-6));
    CHECK(m.viscosity_Pa_s == Approx(same.viscosity_Pa_s).epsilon(1e-6));
    CHECK(m.viscosity_across_Pa_s == Approx(same.viscosity_across_Pa_s).epsilon(1e-6));
    CHECK(m.lambda_Pa == Approx(same.lambda_Pa).epsilon(1e-6));
    CHECK(std::abs(m.normal.x) == Approx(std::abs(same.normal.x) / norm(same.normal)));
    // Points that are further apart than 1.5 cells describe a smooth medium.
    CHECK_FALSE(material_of_cell(medium, 1, middle, 0.6 * cell_m).is_laminate());
}

TEST_CASE("only the depths of bodies and maps vary", "[material_field]") {
    Medium medium = two_layers();
    CHECK_FALSE(varies_between(medium, 0.0, 12e-3));
    medium.bodies = {{.shape = Ellipsoid{{1e-3, 1e-3, 1e-3}}, .centre_m = {0, 0, 5e-3}}};
    CHECK(varies_between(medium, 2e-3, 4.5e-3));
    CHECK_FALSE(varies_between(medium, 0.0, 4e-3));
    CHECK_FALSE(varies_between(medium, 6e-3, 12e-3));
    medium.bodies.clear();
    medium.map = std::make_shared<const MaterialMap>(linear_map());
    CHECK(varies_between(medium, 0.0, 1.8e-3)); // the rim begins at 1.75 mm
    CHECK_FALSE(varies_between(medium, 0.0, 1.7e-3));
    CHECK_FALSE(varies_between(medium, 4.3e-3, 12e-3));
}

TEST_CASE("a value of another property is another case", "[material_field]") {
    Case c;
    c.scene.medium = two_layers();
    CHECK(canonical_text(c).find("map") == std::string::npos);
    CHECK(canonical_text(c).find("body") == std::string::npos);
    c.scene.medium.bodies = {{.shape = Cylinder{.radius_m = 1e-3}, .c_s_m_s = 9.0}};
    Case other = c;
    other.scene.medium.bodies = {{.shape = Cylinder{.radius_m = 1e-3}, .c_p_m_s = 9.0}};
    CHECK(case_id(other) != case_id(c));
    CHECK_FALSE(other == c);
}

TEST_CASE("maps with equal content are equal", "[material_field]") {
    const MaterialMap map = linear_map();
    MaterialMap renamed = map;
    renamed.file = "elsewhere.h5";
    CHECK(hash_of(renamed) == map.content_hash);
    Case a, b;
    a.scene.medium.map = std::make_shared<const MaterialMap>(map);
    b.scene.medium.map = std::make_shared<const MaterialMap>(renamed);
    CHECK(a == b);
    CHECK(case_id(a) == case_id(b));
    const int change = GENERATE(0, 1, 2);
    if (change == 0) renamed.c_s_m_s[7] *= 1.0 + 1e-15;
    if (change == 1) renamed.origin_m.y += 1e-9;
    if (change == 2) renamed.c_p_m_s.swap(renamed.c_s_m_s); // the values are another property's
    renamed.content_hash = hash_of(renamed);
    b.scene.medium.map = std::make_shared<const MaterialMap>(renamed);
    CHECK_FALSE(a == b);
    CHECK(case_id(a) != case_id(b));
}

} // namespace test_material_field
