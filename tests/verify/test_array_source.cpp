// SPDX-License-Identifier: BSD-3-Clause
#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace test_array_source {

using namespace shearwake;
using namespace shearwake::test;

static double relative_l2(const std::vector<double>& a, const std::vector<double>& b) {
    double difference = 0.0, size = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        difference += (a[i] - b[i]) * (a[i] - b[i]);
        size += b[i] * b[i];
    }
    return std::sqrt(difference / size);
}

/// The focus of an array that moves along a slanted line, over 12 mm of tissue.
static Case moving_array(double update_rate_Hz) {
    Case c = focus_over_rigid_base(1.0, {12e-3}, 0.0);
    c.scene.load.footprint = ArrayFootprint{.update_rate_Hz = update_rate_Hz, .reach_m = 0.03};
    travel_of(c).path = {{-9e-3, -4e-3}, {80e-3, 30e-3}};
    c.domain = {48, 40, 3e-3, 0.0};
    c.time = {32, 125e-6};
    c.measure.at_s = c.time.duration_s();
    return c;
}

/// The largest pressure of an array that focuses at the end of the case's path.
static std::vector<double> last_frame(Case c, SolverOptions solver) {
    c.solver = solver;
    return frames_of(c).at(c.time.frames - 1);
}

TEST_CASE("engines layered and spectral agree for a moving array focus", "[verify]") {
    const Case c = moving_array(0.0);
    const auto layered = last_frame(c, LayeredOptions{});
    // Second order in the step of the spectral engine: 0.1 % as for a Gaussian focus of 3 mm at 25
    // us.
    CHECK(relative_l2(last_frame(c, SpectralOptions{}), layered) < 2e-3);
}

TEST_CASE("an update rate of 16 kHz changes the field by less than 5 %", "[verify]") {
    const auto always = last_frame(moving_array(0.0), LayeredOptions{});
    const auto updated = last_frame(moving_array(16e3), LayeredOptions{});
    // The focus is late by half an update interval on average, 0.22 mm of a wake that is 10 mm
    // wide.
    CHECK(relative_l2(updated, always) < 0.05);
    CHECK(relative_l2(updated, always) > 1e-4);
}

TEST_CASE("field of simultaneous foci equals the mean of the single foci", "[verify]") {
    const auto engine = GENERATE(0, 1);
    // The spectral engine uses the same step for all loads.
    const SolverOptions solver = engine == 0
                                     ? SolverOptions(LayeredOptions{})
                                     : SolverOptions(SpectralOptions{.time_step_s = 62.5e-6});
    Case c = moving_array(0.0);
    c.scene.load.footprint = GaussianFootprint{9e-3};
    const std::vector<Vec2> offsets = {{-12e-3, 0.0}, {9e-3, 15e-3}};
    c.scene.load.modulation.foci_m = offsets;
    const auto both = last_frame(c, solver);
    std::vector<double> mean(both.size(), 0.0);
    for (const Vec2& offset : offsets) {
        Case alone = moving_array(0.0);
        alone.scene.load.footprint = GaussianFootprint{9e-3};
        alone.scene.load.modulation.trajectory.parts.push_back(Hold{offset});
        const auto frame = last_frame(alone, solver);
        for (std::size_t i = 0; i < mean.size(); ++i)
            mean[i] += 0.5 * frame[i];
    }
    CHECK(relative_l2(both, mean) < 1e-10); // the same sums in a different order
}

} // namespace test_array_source
