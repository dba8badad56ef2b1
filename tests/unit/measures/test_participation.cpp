// SPDX-License-Identifier: BSD-3-Clause
#include "measures/spatial_measures.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <vector>

namespace test_participation {

using namespace shearwake;

/// n samples displaced by +u and m by -u, `focal` of them in the disc.
static measures::SurfaceSums equal_samples(double n, double m, double u, double focal) {
    return {.u = (n - m) * u,
            .abs_u = (n + m) * u,
            .u2 = (n + m) * u * u,
            .u4 = (n + m) * u * u * u * u,
            .focal_u2 = focal * u * u,
            .focal_weight = 2.0 * focal};
}

TEST_CASE("equal displacements of n samples participate as n samples", "[participation]") {
    const measures::SurfaceSums sums = equal_samples(12, 0, 2e-6, 3);
    // Products and quotients only: a few rounding errors.
    CHECK(measures::ipr(sums) == Approx(12).epsilon(1e-14));
    CHECK(measures::ipr_abs(sums) == Approx(12).epsilon(1e-14));
    CHECK(measures::participation(sums) == Approx(12).epsilon(1e-14));
    CHECK(measures::reconstruction_efficiency(sums) == Approx(0.25).epsilon(1e-14));
}

TEST_CASE("the literal inverse participation ratio vanishes when volume is conserved",
          "[participation]") {
    const measures::SurfaceSums sums = equal_samples(10, 10, 1e-6, 0);
    CHECK(measures::ipr(sums) == 0.0);
    CHECK(measures::ipr_abs(sums) == Approx(20).epsilon(1e-14));
    CHECK(measures::participation(sums) == Approx(20).epsilon(1e-14));
}

TEST_CASE("where nothing has moved there is no number", "[participation]") {
    CHECK(std::isnan(measures::ipr(measures::SurfaceSums{})));
    CHECK(std::isnan(measures::ipr_abs(measures::SurfaceSums{})));
    CHECK(std::isnan(measures::participation(measures::SurfaceSums{})));
    CHECK(std::isnan(measures::reconstruction_efficiency(measures::SurfaceSums{})));
    CHECK(std::isnan(measures::reconstruction_efficiency(measures::PeriodSums{})));
}

TEST_CASE("the period reading sums before it divides", "[participation]") {
    // Two frames of amplitudes 1 and 3; the second spreads twice as wide, its weight is a half.
    const std::vector<measures::SurfaceSums> frames = {
        equal_samples(4, 0, 1e-6, 2), equal_samples(8, 0, 3e-6, 2), measures::SurfaceSums{}};
    const measures::PeriodSums sums =
        measures::period_sums(frames, std::vector<double>{1.0, 0.5, 0.0});
    CHECK(sums.weight == 1.5);
    CHECK(measures::reconstruction_efficiency(sums) == Approx((2 + 0.5 * 18) / (4 + 0.5 * 72)));
    CHECK(measures::ipr(sums) == Approx((16 + 0.5 * 576) / (4 + 0.5 * 72)));
    CHECK(measures::ipr_abs(sums) == Approx((16 + 0.5 * 576) / (4 + 0.5 * 72)));
    CHECK(measures::participation(sums) == Approx((16 + 0.5 * 72 * 72) / (4 + 0.5 * 648)));
    CHECK(sums.focal_u2 == Approx((2 + 0.5 * 18) * 1e-12));
    CHECK(sums.focal_weight == Approx(4 + 0.5 * 4));
}

} // namespace test_participation
