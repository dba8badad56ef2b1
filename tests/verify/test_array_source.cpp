#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace shearwake;
using namespace shearwake::test;

namespace {

double relative_l2(const std::vector<double>& a, const std::vector<double>& b) {
    double difference = 0.0, size = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        difference += (a[i] - b[i]) * (a[i] - b[i]);
        size += b[i] * b[i];
    }
    return std::sqrt(difference / size);
}

/// An array's focus that runs along a slanted line, over 12 mm of tissue.
Case moving_array(double update_rate_Hz) {
    Layer layer = tissue(1500.0);
    layer.thickness_m = 12e-3;
    Case c = moving_focus({{layer}, Base::rigid}, ConstantSpeed{7.0});
    c.load.footprint = ArrayFootprint{.update_rate_Hz = update_rate_Hz, .reach_m = 0.03};
    std::get<Travel>(c.load.modulation.trajectory.parts[0]).path = {{-9e-3, -4e-3}, {80e-3, 30e-3}};
    c.domain = {48, 40, 3e-3, 0.0};
    c.time = {32, 125e-6};
    c.measure.at_s = c.time.duration_s();
    return c;
}

/// The largest pressure of the array that focuses where the case's load ends.
std::vector<double> last_frame(Case c, SolverOptions solver) {
    c.solver = solver;
    return frames_of(c).at(c.time.frames - 1);
}

} // namespace

TEST_CASE("both engines move an array's focus alike", "[verify]") {
    const Case c = moving_array(0.0);
    const auto layered = last_frame(c, LayeredOptions{});
    // Of second order in its step: 0.1 % is what a Gaussian focus of 3 mm has at 25 us.
    CHECK(relative_l2(last_frame(c, SpectralOptions{}), layered) < 2e-3);
}

TEST_CASE("an update rate of 16 kHz is hardly felt", "[verify]") {
    const auto always = last_frame(moving_array(0.0), LayeredOptions{});
    const auto held = last_frame(moving_array(16e3), LayeredOptions{});
    // The focus is late by half an update in the mean, 0.22 mm of a wake 10 mm wide.
    CHECK(relative_l2(held, always) < 0.05);
    CHECK(relative_l2(held, always) > 1e-4);
}

TEST_CASE("foci at a time move the skin as the mean of each alone", "[verify]") {
    const auto engine = GENERATE(0, 1);
    const SolverOptions solver =
        engine == 0 ? SolverOptions(LayeredOptions{})
                    : SolverOptions(SpectralOptions{.time_step_s = 62.5e-6}); // one for all loads
    Case c = moving_array(0.0);
    c.load.footprint = GaussianFootprint{9e-3};
    const std::vector<Vec2> offsets = {{-12e-3, 0.0}, {9e-3, 15e-3}};
    c.load.modulation.foci_m = offsets;
    const auto both = last_frame(c, solver);
    std::vector<double> mean(both.size(), 0.0);
    for (const Vec2& offset : offsets) {
        Case alone = moving_array(0.0);
        alone.load.footprint = GaussianFootprint{9e-3};
        alone.load.modulation.trajectory.parts.push_back(Hold{offset});
        const auto frame = last_frame(alone, solver);
        for (std::size_t i = 0; i < mean.size(); ++i)
            mean[i] += 0.5 * frame[i];
    }
    CHECK(relative_l2(both, mean) < 1e-10); // the same sums in another order
}
