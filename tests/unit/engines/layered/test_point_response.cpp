// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/point_response.hpp"
#include "engines/layered/response/stack_response.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_point_response {

using namespace shearwake;
using Complex = std::complex<double>;

TEST_CASE("the Bessel function agrees with its integral and with the real one",
          "[point_response]") {
    for (const double x : {0.0, 0.3, 2.404825557695773, 7.0, 24.9, 25.1, 80.0, 1200.0})
        CHECK(std::abs(layered::bessel_j0(x) - std::cyl_bessel_j(0.0, x)) < 1e-13);
    for (const double y : {0.5, 3.0, 7.0})
        for (const double x : {0.1, 5.0, 20.0, 24.0, 30.0, 100.0}) {
            const Complex z(x, y);
            Complex mean = 0.0; // of cos(z sin theta), exact to J_1000
            for (int i = 0; i < 500; ++i)
                mean += std::cos(z * std::sin(std::numbers::pi * (i + 0.5) / 500.0)) / 500.0;
            CHECK(std::abs(layered::bessel_j0(z) - mean) < 1e-13 * std::exp(y));
        }
}

TEST_CASE("the response to a static point load is that of Boussinesq", "[point_response]") {
    // u = (1 - nu) / (2 pi mu r), apart from the filter, which acts within some grid spacings.
    const Layer layer = test::tissue();
    const double spacing = 1e-3, reach = 0.1, mu = 1000.0 * 25.0;
    const double ratio = 50.0 * 50.0 / 25.0, nu = 0.5 * (ratio - 2.0) / (ratio - 1.0);
    layered::PointResponse point(spacing, reach);
    const std::vector<double> depths = {0.0};
    const layered::StackResponse response(test::half_space(layer), 0.0, depths);
    std::vector<Complex> h, value(1);
    for (const Complex k : point.nodes_rad_m()) {
        response.evaluate(k, value);
        h.push_back(value[0]);
    }
    const auto table = point.tables(h, 1);
    for (const double r : {60e-3, 80e-3, 100e-3}) {
        const auto at =
            static_cast<std::size_t>(std::lround(r / spacing * layered::radii_per_spacing));
        const double exact = (1.0 - nu) / (2.0 * std::numbers::pi * mu * r);
        // The tail of the filter in space is below 1e-6 from 60 spacings on.
        CHECK(std::abs(table[at] - exact) < 1e-6 * exact);
    }
}

} // namespace test_point_response
