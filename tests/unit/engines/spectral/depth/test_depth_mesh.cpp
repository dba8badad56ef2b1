// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/spectral/stepping/time_step.hpp"

#include "support/cases.hpp"

#include <catch2/catch.hpp>

namespace test_depth_mesh {

using namespace shearwake;

TEST_CASE("Gauss-Lobatto rule integrates and differentiates polynomials exactly", "[spectral]") {
    const int degree = GENERATE(1, 2, 5, 8, 12);
    const spectral::GaussLobatto rule = spectral::gauss_lobatto(degree);
    for (int power = 0; power <= 2 * degree - 1; ++power) {
        double sum = 0.0;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i)
            sum += rule.weights[i] * std::pow(rule.nodes[i], power);
        CHECK(sum == Approx(power % 2 ? 0.0 : 2.0 / (power + 1)).margin(1e-14));
    }
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        double d = 0.0;
        for (std::size_t j = 0; j < rule.nodes.size(); ++j)
            d += rule.derivative[i * rule.nodes.size() + j] * std::pow(rule.nodes[j], degree);
        // Entries and their rounding errors grow as degree^2.
        CHECK(d == Approx(degree * std::pow(rule.nodes[i], degree - 1)).margin(1e-12));
    }
}

TEST_CASE("elements end at interfaces, are shortest at the surface and fill the medium",
          "[spectral][slow]") {
    Case c = test::moving_focus({}, ConstantSpeed{7.0});
    c.scene.medium.base = Base::rigid;
    for (const double thickness_m : {0.1e-3, 2e-3, 18e-3}) {
        c.scene.medium.layers.push_back(test::tissue(1500.0));
        c.scene.medium.layers.back().thickness_m = thickness_m;
    }
    const spectral::DepthMesh mesh = spectral::choose_mesh(c, SpectralOptions{});
    CHECK(mesh.ends_m.back() == Approx(20.1e-3).epsilon(1e-13));
    for (const double interface_m : {0.1e-3, 2.1e-3}) {
        double nearest = 1.0;
        for (const double end : mesh.ends_m)
            nearest = std::min(nearest, std::abs(end - interface_m));
        CHECK(nearest < 1e-15);
    }
    for (std::size_t level = 1; level < mesh.levels(); ++level)
        CHECK(mesh.z_m(level) > mesh.z_m(level - 1));
    CHECK(mesh.z_m(0) == 0.0);
    CHECK(spectral::choose_mesh(c, SpectralOptions{.longest_element_m = 1e-3}).levels() >
          mesh.levels());
}

TEST_CASE("a half-space ends in an absorber below all measured depths", "[spectral][slow]") {
    Case c = test::moving_focus(test::half_space(test::tissue(1500.0)), ConstantSpeed{7.0});
    c.scene.medium.layers.insert(c.scene.medium.layers.begin(), c.scene.medium.layers[0]);
    c.scene.medium.layers[0].thickness_m = 2e-3;
    c.measure.depths_m = {0.0, 30e-3};
    const spectral::DepthMesh mesh = spectral::choose_mesh(c, SpectralOptions{});
    REQUIRE(mesh.bottom);
    CHECK(mesh.clear_depth_m() == Approx(33e-3)); // one focus width deeper
    CHECK(mesh.z_m(mesh.clear_levels() - 1) == Approx(mesh.clear_depth_m()));
    CHECK(mesh.clear_levels() < mesh.levels());
    CHECK(mesh.bottom->depth_m == Approx(0.8 * c.domain.extent_x_m()));
    CHECK(spectral::choose_mesh(c, SpectralOptions{.absorbing_depth_m = 50e-3}).bottom->depth_m ==
          50e-3);
    const Layer& last = c.scene.medium.layers.back();
    CHECK(spectral::swirl_viscosity_Pa_s(*mesh.bottom, last, 0.0) == 0.0); // starts continuously
    CHECK(spectral::swirl_viscosity_Pa_s(*mesh.bottom, last, 0.1) > 0.0);
    c.scene.medium.base = Base::rigid;
    c.scene.medium.layers[1].thickness_m = 40e-3;
    const spectral::DepthMesh rigid = spectral::choose_mesh(c, SpectralOptions{});
    CHECK(rigid.clear_levels() == rigid.levels());
}

} // namespace test_depth_mesh
