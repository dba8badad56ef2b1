// SPDX-License-Identifier: BSD-3-Clause
#include "problem/case/case.hpp"

#include <catch2/catch.hpp>

namespace test_case {

using namespace shearwake;

static Case some_case() {
    Case c;
    c.scene.medium.layers = {Layer{.name = "tissue",
                                   .thickness_m = 0.02,
                                   .density_kg_m3 = 1000.0,
                                   .c_p_m_s = 1500.0,
                                   .c_s_m_s = 5.0,
                                   .loss = KelvinVoigt{1.0}}};
    c.scene.load.peak_Pa = 100.0;
    c.scene.load.footprint = GaussianFootprint{0.003};
    c.scene.load.modulation = {"AM", {{Hold{}}}, {{SineGain{200.0}}}};
    c.domain = {.nx = 256, .ny = 180, .spacing_m = 0.00075};
    c.time = {.frames = 280, .interval_s = 5e-5};
    c.measure = {.at_s = 0.014, .settled_after_s = 0.004, .focal_radius_m = 0.003};
    c.record.traces_m = {{}};
    return c;
}

static bool is_good(std::ptrdiff_t n) {
    for (const std::ptrdiff_t prime : {2, 3, 5, 7})
        while (n % prime == 0)
            n /= prime;
    return n == 1;
}

TEST_CASE("a grid length is the smallest even product of small primes", "[case]") {
    for (std::ptrdiff_t n = 1; n < 600; ++n) {
        std::ptrdiff_t slow = n + n % 2;
        while (!is_good(slow))
            slow += 2;
        CHECK(good_even_length(n) == slow);
    }
}

TEST_CASE("the domain is centred on the origin", "[case]") {
    const Domain domain{.nx = 256, .ny = 180, .spacing_m = 0.5};
    CHECK(domain.x_m(128) == 0.0);
    CHECK(domain.x_m(0) == -64.0);
    CHECK(domain.y_m(179) == 44.5);
    CHECK(domain.extent_x_m() == 128.0);
}

TEST_CASE("frames are at multiples of the interval, the first one after the start", "[case]") {
    const TimeAxis time{.frames = 280, .interval_s = 5e-5};
    CHECK(time.frame_s(0) == 5e-5);
    CHECK(time.frame_s(279) == time.duration_s());
}

TEST_CASE("equal cases have equal texts and ids", "[case]") {
    CHECK(canonical_text(some_case()) == canonical_text(some_case()));
    CHECK(case_id(some_case()) == case_id(some_case()));
    CHECK(case_id(some_case()).size() == 16);
    Case signed_zero = some_case();
    signed_zero.scene.load.modulation.trajectory.parts = {Hold{{-0.0, 0.0}}};
    CHECK(case_id(signed_zero) == case_id(some_case()));
}

TEST_CASE("the accuracy of a given time step is not part of a case", "[case]") {
    Case c = some_case();
    c.solver = SpectralOptions{.time_step_s = 1e-5, .accuracy = 1e-2};
    CHECK(canonical_text(c).find("accuracy") == std::string::npos);
}

TEST_CASE("a name with quotes and control characters is written as one TOML string", "[case]") {
    Case c = some_case();
    c.scene.medium.layers[0].name = "a\"b\\c\n";
    CHECK(canonical_text(c).find(R"(name = "a\"b\\c\u000a")") != std::string::npos);
}

} // namespace test_case
