#include "engines/pstd/material.hpp"

#include <catch2/catch.hpp>

using namespace shearwake::pstd;

namespace {

const Grid grid{{4, 4, 4}, {1e-3, 1e-3, 1e-3}, 1e-6};

} // namespace

TEST_CASE("shear points between nodes have the harmonic mean of four", "[pstd]") {
    const auto value = [](Node n) { return 1.0 + static_cast<double>(n[0] + 2 * n[2]); };
    // 1, 2, 3 and 4 around (1/2, ., 1/2).
    CHECK(harmonic_between(grid, value, {0, 1, 0}, 0, 2) ==
          Approx(4.0 / (1.0 + 0.5 + 1.0 / 3.0 + 0.25)).epsilon(1e-15));
    // The upper edge has nothing to average with, along either axis.
    CHECK(harmonic_between(grid, value, {3, 1, 0}, 0, 2) == 4.0);
    CHECK(harmonic_between(grid, value, {0, 1, 3}, 0, 2) == 7.0);
}

TEST_CASE("a shear point beside a fluid node has no shear modulus, on whichever side", "[pstd]") {
    const Node fluid = GENERATE(Node{1, 1, 1}, Node{2, 1, 1}, Node{1, 1, 2}, Node{2, 1, 2});
    const auto value = [&](Node n) { return n == fluid ? 0.0 : 3.0; };
    CHECK(harmonic_between(grid, value, {1, 1, 1}, 0, 2) == 0.0);
    CHECK(harmonic_between(grid, value, {1, 2, 1}, 0, 2) == 3.0);
}

TEST_CASE("a fluid above makes the shear point of the upper edge fluid as well", "[pstd]") {
    const auto value = [](Node n) { return n[2] > 1 ? 0.0 : 3.0; };
    CHECK(harmonic_between(grid, value, {3, 1, 1}, 0, 2) == 0.0);
    CHECK(harmonic_between(grid, value, {3, 1, 0}, 0, 2) == 3.0);
}

TEST_CASE("along an axis of one point a node is its own neighbour", "[pstd]") {
    const Grid line{{1, 1, 4}, {1e-3, 1e-3, 1e-3}, 1e-6};
    const auto value = [](Node n) { return n[2] < 2 ? 1.0 : 3.0; };
    CHECK(harmonic_between(line, value, {0, 0, 1}, 0, 2) == Approx(1.5).epsilon(1e-15));
    CHECK(harmonic_between(line, value, {0, 0, 3}, 0, 2) == 3.0);
}

TEST_CASE("velocity points between nodes have the mean density of two", "[pstd]") {
    const auto material = [](Node n) {
        return NodeMaterial{.density_kg_m3 = n[1] < 2 ? 900.0 : 1300.0};
    };
    CHECK(density_between(grid, material, {0, 1, 0}, 1) == 1100.0);
    CHECK(density_between(grid, material, {0, 1, 0}, 0) == 900.0);
    CHECK(density_between(grid, material, {0, 3, 0}, 1) == 1300.0); // the upper edge
}

TEST_CASE("k-Wave's absorption gives waves its decibels", "[pstd]") {
    // At 1 MHz a P wave of Kelvin-Voigt loses w^2 (chi + 2 eta)/(2 rho c_p^3) Np/m.
    const NodeMaterial m = with_kwave_absorption({1100.0, 1500.0, 80.0}, 0.5, 7.0);
    const double w_rad_s = 2.0 * 3.14159265358979323846 * 1e6;
    const auto dB_cm = [&](double viscosity_Pa_s, double c_m_s) {
        const double np_m =
            w_rad_s * w_rad_s * viscosity_Pa_s / (2.0 * 1100.0 * c_m_s * c_m_s * c_m_s);
        return np_m * 20.0 * 0.43429448190325182765 / 100.0;
    };
    CHECK(dB_cm(m.chi_Pa_s + 2.0 * m.eta_Pa_s, 1500.0) == Approx(0.5).epsilon(1e-12));
    CHECK(dB_cm(m.eta_Pa_s, 80.0) == Approx(7.0).epsilon(1e-12));
}
