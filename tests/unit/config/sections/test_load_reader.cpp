// SPDX-License-Identifier: BSD-3-Clause
#include "unit/config/jobs.hpp"

#include <numbers>

namespace test_load_reader {

using namespace shearwake;
using namespace shearwake::test;

static Modulation modulation_of(std::string_view modulation) {
    return only_case(with_modulation(modulation)).scene.load.modulation;
}

const std::string path = "path = { shape = \"line\", from_mm = [-14, 0], to_mm = [14, 0] }\n";
const Line line = {{-0.014, 0.0}, {0.014, 0.0}};

TEST_CASE("AM is a fixed point with a sine gain", "[config][load]") {
    const Modulation am = modulation_of("kind = \"AM\"\nam_frequency_Hz = 500");
    CHECK(am == Modulation{"AM", {{Hold{}}}, {{SineGain{500.0}}}});
    const Modulation all =
        modulation_of("kind = \"AM\"\nam_frequency_Hz = 500\nam_depth = 0.4\nam_phase_deg = 90\n"
                      "am_on = \"pressure\"\nposition_mm = [1, -2]\nramp_ms = 2");
    CHECK(all.trajectory == Trajectory{{Hold{{0.001, -0.002}}}});
    const auto& sine = std::get<SineGain>(all.envelope.gains.at(0));
    CHECK(sine.depth == 0.4);
    CHECK(sine.phase_rad == Approx(0.5 * std::numbers::pi).epsilon(1e-15));
    CHECK(sine.on == GainOn::pressure);
    CHECK(all.envelope.gains.at(1) == Gain(RampGain{0.002}));
}

TEST_CASE("STM is a path at constant speed", "[config][load]") {
    CHECK(modulation_of("kind = \"STM\"\nspeed_m_s = 7\n" + path) ==
          Modulation{"STM", {{Travel{line, ConstantSpeed{7.0}, AtEnd::off}}}, {}});
}

TEST_CASE("a Mach number is a speed over that of the top layer", "[config][load]") {
    CHECK(modulation_of("kind = \"STM\"\nmach = 1.4\n" + path) ==
          modulation_of("kind = \"STM\"\nspeed_m_s = 7.0\n" + path));
}

TEST_CASE("the focus can rest at the end of a path", "[config][load]") {
    const Modulation stm =
        modulation_of("kind = \"STM\"\nspeed_m_s = 7\npath = { shape = \"line\", from_mm = [-14, "
                      "0], to_mm = [14, 0], at_end = \"hold\" }");
    CHECK(std::get<Travel>(stm.trajectory.parts.at(0)).at_end == AtEnd::hold);
}

TEST_CASE("SM-STM is a path at oscillating speed", "[config][load]") {
    CHECK(modulation_of("kind = \"SM-STM\"\nspeed_m_s = 7\nspeed_deviation_m_s = 2\n"
                        "sm_frequency_Hz = 500\n" +
                        path) ==
          Modulation{"SM-STM", {{Travel{line, OscillatingSpeed{7.0, 2.0, 500.0, 0.0}}}}, {}});
}

TEST_CASE("a carrier can be resolved", "[config][load]") {
    const auto carrier = [](std::string_view more) {
        return only_case(plain_with("peak_Pa = 100.0\n", "peak_Pa = 100.0\n" + std::string(more)))
            .scene.load.carrier;
    };
    CHECK(carrier("") == Carrier(AveragedCarrier{}));
    CHECK(carrier("carrier = \"averaged\"\n") == Carrier(AveragedCarrier{}));
    CHECK(carrier("carrier = \"resolved\"\n") == Carrier(ResolvedCarrier{40e3}));
    CHECK(carrier("carrier = \"resolved\"\ncarrier_kHz = 25\n") == Carrier(ResolvedCarrier{25e3}));
}

TEST_CASE("an error in the load is reported with its location", "[config][load]") {
    const auto [old, by, diagnostic] = GENERATE(table<std::string, std::string, std::string>({
        {"footprint = {", "carrier_kHz = 40\nfootprint = {",
         "15:15 carrier_kHz applies only with carrier = \"resolved\""},
    }));
    const Texts found = diagnostics_of(plain_with(old, by));
    CHECK(any_contains(found, error_at(diagnostic, "load.")));
}

TEST_CASE("an error in the modulation is reported with its location", "[config][load]") {
    const auto [old, by, diagnostic] = GENERATE(table<std::string, std::string, std::string>({
        {"\"AM-STM\"", "\"STM\"", "20:19 modulation.am_frequency_Hz does not apply to kind STM"},
        {"to_mm = [14.0, 0.0]", "to_mm = [-14.0, 0.0]",
         "18:58 modulation.path.to_mm equals the start of the path, so the path has no length"},
        {"speed_m_s = 7.0", "speed_m_s = 7.0\nmach = 1.4",
         "20:8 modulation.mach and speed_m_s are both given; remove one of them from the job"},
        {"speed_m_s = 7.0\n", "", "16:1 modulation.speed_m_s is missing (or mach, the speed"},
        {"speed_m_s = 7.0\n", "draw_frequency_Hz = 70\n",
         "19:21 modulation.draw_frequency_Hz requires a path that repeats: set path.at_end = "
         "\"repeat\" or \"back-and-forth\", or give speed_m_s or mach instead"},
    }));
    const Texts found = diagnostics_of(plain_with(old, by));
    CHECK(any_contains(found, error_at(diagnostic, "load.")));
    CHECK(found.size() <= 2);
}

TEST_CASE("a focus that would move backwards is rejected", "[config][load]") {
    const std::string sm = "kind = \"SM-STM\"\nspeed_m_s = 7\nspeed_deviation_m_s = 7\n"
                           "sm_frequency_Hz = 500\n" +
                           path;
    CHECK(diagnostics_of(with_modulation(sm)) ==
          Texts{error_at("19:23 load.modulation.speed_deviation_m_s must be below the mean speed "
                         "of 7 m/s, but is 7: the focus would move backwards along its path")});
}

TEST_CASE("errors behind a misspelled kind and shape are reported at once", "[config][load]") {
    std::string job = plain_with("\"AM-STM\"", "\"am-stm\"");
    job = replaced(job, "shape = \"line\", from_mm = [-14.0, 0.0], to_mm = [14.0, 0.0]",
                   "shape = \"circel\", radius_mm = \"10,0\"");
    job = replaced(job, "am_frequency_Hz = 500.0", "am_frequency_Hz = 0");
    const Texts found = diagnostics_of(job);
    CHECK(found.size() == 4);
    CHECK(any_contains(found, "did you mean \"AM-STM\"?"));
    CHECK(any_contains(found, "did you mean \"circle\"?"));
    CHECK(any_contains(found, "write decimal numbers with a point: 10.0"));
    CHECK(any_contains(found, "load.modulation.am_frequency_Hz must be"));
}

TEST_CASE("an abbreviated key is suggested in full and not reported as missing", "[config][load]") {
    CHECK(diagnostics_of(plain_with("speed_m_s = 7.0\n", "draw_freq_Hz = 70\n")) ==
          Texts{error_at(
              "19:1 load.modulation.draw_freq_Hz is unknown; did you mean draw_frequency_Hz?")});
}

} // namespace test_load_reader
