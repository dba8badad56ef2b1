// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scheme/material.hpp"

#include <catch2/catch.hpp>

namespace test_pstd_material {

using namespace shearwake;
using namespace shearwake::pstd;

const pstd::Grid grid{{4, 4, 4}, {1e-3, 1e-3, 1e-3}, 1e-6};

TEST_CASE("shear points between nodes have the harmonic mean of four nodes", "[pstd]") {
    const auto value = [](pstd::Node n) { return 1.0 + static_cast<double>(n[0] + 2 * n[2]); };
    // Values 1, 2, 3 and 4 around (1/2, ., 1/2).
    CHECK(pstd::harmonic_between(grid, value, {0, 1, 0}, 0, 2) ==
          Approx(4.0 / (1.0 + 0.5 + 1.0 / 3.0 + 0.25)).epsilon(1e-15));
    // The upper edge has no neighbour along either axis.
    CHECK(pstd::harmonic_between(grid, value, {3, 1, 0}, 0, 2) == 4.0);
    CHECK(pstd::harmonic_between(grid, value, {0, 1, 3}, 0, 2) == 7.0);
}

TEST_CASE("shear points next to a fluid node on any side have no shear modulus", "[pstd]") {
    const pstd::Node fluid = GENERATE(pstd::Node{1, 1, 1}, pstd::Node{2, 1, 1}, pstd::Node{1, 1, 2},
                                      pstd::Node{2, 1, 2});
    const auto value = [&](pstd::Node n) { return n == fluid ? 0.0 : 3.0; };
    CHECK(pstd::harmonic_between(grid, value, {1, 1, 1}, 0, 2) == 0.0);
    CHECK(pstd::harmonic_between(grid, value, {1, 2, 1}, 0, 2) == 3.0);
}

TEST_CASE("shear points of the upper edge next to a fluid have no shear modulus", "[pstd]") {
    const auto value = [](pstd::Node n) { return n[2] > 1 ? 0.0 : 3.0; };
    CHECK(pstd::harmonic_between(grid, value, {3, 1, 1}, 0, 2) == 0.0);
    CHECK(pstd::harmonic_between(grid, value, {3, 1, 0}, 0, 2) == 3.0);
}

TEST_CASE("a node is its own neighbour along an axis with a single point", "[pstd]") {
    const pstd::Grid line{{1, 1, 4}, {1e-3, 1e-3, 1e-3}, 1e-6};
    const auto value = [](pstd::Node n) { return n[2] < 2 ? 1.0 : 3.0; };
    CHECK(pstd::harmonic_between(line, value, {0, 0, 1}, 0, 2) == Approx(1.5).epsilon(1e-15));
    CHECK(pstd::harmonic_between(line, value, {0, 0, 3}, 0, 2) == 3.0);
}

TEST_CASE("velocity points between nodes have the mean density of two nodes", "[pstd]") {
    const auto material = [](pstd::Node n) {
        return pstd::NodeMaterial{.density_kg_m3 = n[1] < 2 ? 900.0 : 1300.0};
    };
    CHECK(pstd::density_between(grid, material, {0, 1, 0}, 1) == 1100.0);
    CHECK(pstd::density_between(grid, material, {0, 1, 0}, 0) == 900.0);
    CHECK(pstd::density_between(grid, material, {0, 3, 0}, 1) == 1300.0); // upper edge
}

} // namespace test_pstd_material
