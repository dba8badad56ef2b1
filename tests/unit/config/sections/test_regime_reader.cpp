// SPDX-License-Identifier: BSD-3-Clause
// Open edges, the periodic regime and the measured region.
#include "engines/registry/check.hpp"
#include "unit/config/jobs.hpp"

#include <fmt/format.h>

namespace test_regime_reader {

using namespace shearwake;
using namespace shearwake::test;

/// A circle of 62.8 mm with AM at 200 Hz, drawn `draws` times per second for ever.
static std::string steady_job(std::string_view draws = "100.0", std::string_view more = "") {
    std::string job =
        plain_with("path = { shape = \"line\", from_mm = [-14.0, 0.0], to_mm = [14.0, 0.0] }",
                   "path = { shape = \"circle\", radius_mm = 10.0 }");
    job = replaced(job, "speed_m_s = 7.0", "draw_frequency_Hz = " + std::string(draws));
    job = replaced(job, "am_frequency_Hz = 500.0", "am_frequency_Hz = 200.0");
    job = replaced(job, "spacing_mm = 0.75", "spacing_mm = 0.75\nedges = \"open\"");
    job = replaced(job, "duration_ms = 4.0\n", "regime = \"periodic\"\n");
    return job + std::string(more);
}

/// The keys and messages of the errors of a valid job for its engine.
static Texts errors_of(const Case& c) {
    Texts errors;
    for (const Remark& remark : check(c))
        if (remark.severity == Severity::error) errors.push_back(remark.key + " " + remark.message);
    return errors;
}

TEST_CASE("the frames of the periodic regime cover the least common period", "[config][regime]") {
    const Case c = only_case(steady_job());
    CHECK(c.domain.edges == DomainEdges::open);
    CHECK(c.time.regime == Regime::periodic);
    CHECK(c.time.duration_s() == Approx(10e-3).epsilon(1e-12));
    CHECK(c.time.frames == 200); // 50 us, an even number with fast FFTs
    CHECK(c.measure.at_s == c.time.duration_s());
    CHECK(errors_of(c).empty());
    // 70 and 200 Hz have 100 ms in common; 2000 frames are 2000 = 2^4 5^3.
    CHECK(only_case(steady_job("70.0")).time.frames == 2000);
    // 30 and 200 Hz also, but 33 us do not divide it: the interval becomes shorter.
    const TimeAxis shorter = only_case(replaced(steady_job("30.0"), "= 50.0", "= 33.0")).time;
    CHECK(shorter.duration_s() == Approx(100e-3).epsilon(1e-12));
    CHECK(shorter.interval_s <= 33e-6);
}

TEST_CASE("a load without a common period is rejected with its frequencies", "[config][regime]") {
    const auto [job, said] = GENERATE(table<std::string, std::string>({
        {steady_job("70.71067811865"), "70.710678 and 200 Hz"},
        {replaced(steady_job("70.0"), "regime =", "longest_period_ms = 50.0\nregime ="),
         "no common period of up to 50 ms"},
        {plain_with("duration_ms = 4.0", "regime = \"periodic\""),
         "time.regime is \"periodic\", but the load has a path that ends"},
    }));
    CHECK(any_contains(diagnostics_of(job), said));
}

TEST_CASE("the periodic regime needs open edges, losses and the engine layered",
          "[check][regime]") {
    Case c = only_case(steady_job());
    c.domain.edges = DomainEdges::periodic;
    CHECK(any_contains(errors_of(c), "time.regime is \"periodic\", which requires domain.edges"));
    c = only_case(steady_job());
    c.scene.medium.layers[0].loss = KelvinVoigt{0.0};
    CHECK(any_contains(errors_of(c), "layer \"tissue\" is lossless"));
    for (const SolverOptions& other :
         {SolverOptions(SpectralOptions{}), SolverOptions(PstdOptions{})}) {
        c = only_case(steady_job());
        c.solver = other;
        CHECK(any_contains(errors_of(c), "domain.edges is \"open\", which the engine"));
        CHECK(any_contains(errors_of(c), "time.regime is \"periodic\", which the engine"));
    }
}

TEST_CASE("the measured region is a rectangle, the path or the palm", "[config][region]") {
    const auto region = [](std::string_view keys) {
        return only_case(plain_and("[measure]\n" + std::string(keys))).measure.region_m;
    };
    CHECK(only_case(plain_job).measure.region_m.empty());
    CHECK(region("region_mm = [40, 20]\nregion_center_mm = [0, 10]\n") ==
          std::vector<Vec2>{{-0.02, 0.0}, {0.02, 0.0}, {0.02, 0.02}, {-0.02, 0.02}});
    const auto path = region("region_mm = \"path\"\n");
    REQUIRE(path.size() == 4);
    CHECK(path[0].x == Approx(-44e-3));
    CHECK(path[2].y == Approx(30e-3));
    const std::string line =
        "path = { shape = \"line\", from_mm = [-14.0, 0.0], to_mm = [14.0, 0.0] }";
    // Sampled points miss the extent of a circle along y; the region does not.
    for (const double radius_mm : {1.0, 6.0, 7.3}) {
        const double far_m = (30.0 + radius_mm) / 1e3;
        const auto around =
            only_case(test::plain_with(line, fmt::format("path = {{ shape = \"circle\", "
                                                         "radius_mm = {} }}",
                                                         radius_mm)) +
                      "\n[measure]\nregion_mm = \"path\"\n")
                .measure.region_m;
        CHECK(around == std::vector<Vec2>{
                            {-far_m, -far_m}, {far_m, -far_m}, {far_m, far_m}, {-far_m, far_m}});
    }
    CHECK(region("region_mm = \"palm\"\n").size() > 4);
    CHECK(only_case(steady_job()).measure.region_m.size() == 4); // the path
    CHECK(any_contains(diagnostics_of(plain_and("[measure]\nregion_mm = [100, 20]\n")),
                       "must lie inside the domain without its sponge"));
    CHECK(any_contains(diagnostics_of(plain_and("[measure]\nregion_center_mm = [1, 2]\n")),
                       "applies only with a rectangle"));
}

} // namespace test_regime_reader
