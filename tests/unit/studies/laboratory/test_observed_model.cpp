// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/observed_data.hpp"
#include "unit/config/jobs.hpp"

#include <algorithm>
#include <cmath>

namespace test_observed_model {

using namespace shearwake;
using namespace shearwake::test;

namespace {

constexpr double rate_Hz = 20e3; // one sample per frame

/// Scans of the plain job at a coarser grid.
Case coarse_case() {
    std::string job = replaced(plain_job, "spacing_mm = 0.75", "spacing_mm = 2.0");
    job = replaced(job, "fwhm_mm = 3.0", "fwhm_mm = 9.0");
    return only_case(job + "[vibrometer]\npoints_mm = [[0, 0]]\n[solver]\nengine = \"layered\"\n");
}

laboratory::ConvertedData two_points() {
    laboratory::ConvertedData data;
    data.rate_Hz = rate_Hz;
    data.samples = 200;
    data.points_m = {{0.0, 0.0}, {0.011, 0.003}};
    data.direction = {0.0, 0.0, 1.0};
    return data;
}

Case delayed(Case c, double samples) {
    c.vibrometer->trigger_delay_s = samples / rate_Hz;
    return c;
}

} // namespace

TEST_CASE("a later trigger shifts all samples of a prediction, the last ones too", "[laboratory]") {
    const Comm alone = Comm::world().split(Comm::world().rank());
    const Case c = coarse_case();
    const laboratory::ConvertedData data = two_points();
    const std::size_t samples =
        laboratory::covered_samples(laboratory::observed_case(c, data), data);
    REQUIRE(samples == 81);
    laboratory::ObservedModel model(data, samples, alone);
    const auto reference = model.velocities_m_s(c), next = model.velocities_m_s(delayed(c, 1.0)),
               longer = model.velocities_m_s(delayed(c, 6.0)),
               far = model.velocities_m_s(delayed(c, 40.0));
    const double peak = *std::max_element(reference.begin(), reference.end());
    REQUIRE(peak > 0.0);
    for (std::size_t point = 0; point < 2; ++point) {
        const std::size_t first = point * samples;
        // The same motion: rounding of the times.
        for (std::size_t n = 0; n + 1 < samples; ++n)
            CHECK(std::abs(next[first + n] - reference[first + n + 1]) < 1e-9 * peak);
        for (std::size_t n = 0; n + 5 < samples; ++n)
            CHECK(std::abs(longer[first + n] - next[first + n + 5]) < 1e-9 * peak);
        // A motion that is computed for a longer time has other frequencies.
        for (std::size_t n = 0; n + 34 < samples; ++n)
            CHECK(std::abs(far[first + n] - longer[first + n + 34]) < 1e-3 * peak);
    }
}

TEST_CASE("a case covers the samples of a scan that precede its end", "[laboratory]") {
    const Case c = coarse_case();
    laboratory::ConvertedData data = two_points();
    const auto covered = [&](double delay) {
        return laboratory::covered_samples(laboratory::observed_case(delayed(c, delay), data),
                                           data);
    };
    CHECK(covered(10.0) == 71);
    CHECK(covered(-10.0) == 91);
    CHECK(covered(100.0) == 0);
    data.samples = 30;
    CHECK(covered(10.0) == 30);
}

TEST_CASE("a scan outside of the domain is rejected", "[laboratory]") {
    laboratory::ConvertedData data = two_points();
    data.points_m.push_back({0.0, 0.2});
    CHECK_THROWS_WITH(laboratory::observed_case(coarse_case(), data),
                      Catch::Contains("a point at [0, 200] mm outside of the domain"));
}

} // namespace test_observed_model
