// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/bessel_blocks.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace test_bessel_blocks {

using namespace shearwake;
using layered::BesselBlocks;

TEST_CASE("products with kept Bessel functions equal the sums over the wavenumbers",
          "[point_response]") {
    const std::vector<double> k = {0.0, 10.0, 700.0, 3000.0};
    const double step_m = 0.25e-3;
    const std::size_t radii = layered::radii_together + 40; // two blocks
    REQUIRE(BesselBlocks<double>::cached_B(k.size(), radii) > 0.0);
    BesselBlocks<double> blocks(k, step_m, radii);
    for (const double factor : {1.0, -3.0}) { // the second time from the kept blocks
        BesselBlocks<double>::Matrix weights(4, 2);
        weights << 1.0, 0.0, 2.0, -1.0, 0.5, 3.0, 4.0, 1.0;
        weights *= factor;
        std::size_t passed = 0;
        blocks.multiply(weights, [&](std::size_t first, const auto& products) {
            REQUIRE(first == passed);
            passed += static_cast<std::size_t>(products.rows());
            for (Eigen::Index r = 0; r < products.rows(); ++r)
                for (Eigen::Index c = 0; c < 2; ++c) {
                    double sum = 0.0;
                    for (Eigen::Index i = 0; i < 4; ++i) {
                        const double radius_m =
                            step_m * (static_cast<double>(first) + static_cast<double>(r));
                        sum += weights(i, c) *
                               std::cyl_bessel_j(0.0, k[static_cast<std::size_t>(i)] * radius_m);
                    }
                    // Rounding of both Bessel functions at an argument of up to 220.
                    REQUIRE(std::abs(products(r, c) - sum) < 1e-12);
                }
            return true;
        });
        CHECK(passed == radii);
    }
}

TEST_CASE("Bessel functions that need too much memory are not kept", "[point_response]") {
    const auto most = static_cast<std::size_t>(BesselBlocks<double>::most_cached_B / 8.0);
    CHECK(BesselBlocks<double>::cached_B(most / 1000, 1000) == 8.0 * static_cast<double>(most));
    CHECK(BesselBlocks<double>::cached_B(most / 1000 + 1, 1000) == 0.0);
}

} // namespace test_bessel_blocks
