// SPDX-License-Identifier: BSD-3-Clause
// Engine "spectral" with a body that has a smooth edge: its errors in depth and in the plane
// decrease faster than any power of the resolution.
#include "support/orders.hpp"
#include "support/spectral_cases.hpp"

#include <catch2/catch.hpp>

namespace test_spectral_convergence {

using namespace shearwake;

/// A column four times stiffer through all depths, smooth from its axis outward, under a wide
/// focus. A load that is switched on instantly would cause compressional waves that no grid
/// resolves.
static Case column_case() {
    Case c = test::small_tissue();
    c.scene.medium.layers[0].thickness_m = 9e-3;
    c.scene.load.footprint = GaussianFootprint{6e-3};
    c.scene.load.modulation.envelope = {{RampGain{1e-3}}};
    test::travel_of(c).path = {{-7e-3, 0.0}, {200e-3, 0.0}};
    c.time.frames = 20;
    c.scene.medium.bodies = {{.name = "column",
                              .shape = Cylinder{.radius_m = 8e-3, .axis = CylinderAxis::vertical},
                              .centre_m = {2e-3, 1e-3, 0.0},
                              .edge_m = 14e-3,
                              .c_s_m_s = 10.0}};
    return c;
}

static SpectralOptions one_solve(double step_s) {
    // Without iterations, so that the differences do not contain their residual.
    return {.time_step_s = step_s, .method = SpectralMethod::one_solve};
}

TEST_CASE("error decreases faster than any power of the element degree", "[verify]") {
    Case c = column_case();
    c.domain = {32, 24, 3e-3, 0.0};
    // The steps are so short that no element up to degree 9 needs stabilisation. All runs have the
    // same time error, which cancels in the differences.
    SpectralOptions options = one_solve(5e-6);
    options.longest_element_m = 2.25e-3; // four elements at every degree from 4 on
    const auto at_degree = [&](int degree) {
        options.degree = degree;
        c.solver = options;
        return test::last_frame(c);
    };
    const auto finest = at_degree(9);
    double coarser = 0.0, power = 0.0;
    for (const int degree : {4, 5, 6, 7}) {
        const double error = test::relative_l2(at_degree(degree), finest);
        CAPTURE(degree, coarser, error);
        if (degree > 4) {
            const double steeper = std::log(coarser / error) / std::log(degree / (degree - 1.0));
            CHECK(steeper > power + 1.0);  // observed: by 3 to 5, from 13 on
            CHECK(coarser / error > 15.0); // observed 19
            power = steeper;
        }
        coarser = error;
    }
    CHECK(coarser < 1e-7); // observed 9e-9
    test::check_order("spectral, degree of the elements, steepest", 13.0, power, 0.0);
}

TEST_CASE("error decreases faster than any power of the grid spacing", "[verify]") {
    Case c = column_case();
    c.solver = one_solve(25e-6);
    const std::ptrdiff_t finest_n = 96;
    const auto on_grid = [&](std::ptrdiff_t n) {
        c.domain = {n, n, 48e-3 / static_cast<double>(n), 0.0};
        return test::last_frame(c);
    };
    const auto finest = on_grid(finest_n);
    double coarser = 0.0, power = 0.0;
    std::ptrdiff_t coarser_n = 0;
    for (const std::ptrdiff_t n : {12, 16, 24, 32}) { // 4, 3, 2 and 1.5 mm
        const auto frame = on_grid(n);
        std::vector<double> common;
        for (std::ptrdiff_t i = 0; i < n; ++i)
            for (std::ptrdiff_t j = 0; j < n; ++j)
                common.push_back(
                    finest[static_cast<std::size_t>((i * finest_n + j) * (finest_n / n))]);
        const double error = test::relative_l2(frame, common);
        CAPTURE(n, coarser, error);
        if (coarser_n > 0) {
            const double steeper =
                std::log(coarser / error) /
                std::log(static_cast<double>(n) / static_cast<double>(coarser_n));
            CHECK(steeper > power + 0.5);
            power = steeper;
        }
        coarser = error;
        coarser_n = n;
    }
    CHECK(coarser < 1e-3);
    // A sharp face is averaged over cells, which limits the order.
    test::check_order("spectral, grid spacing, smooth body, steepest", 5.0, power, 0.0);
}

} // namespace test_spectral_convergence
