// SPDX-License-Identifier: BSD-3-Clause
#include "neural/respond.hpp"
#include "support/neural_data.hpp"

#include <catch2/catch.hpp>

namespace test_respond {

using namespace shearwake;
using namespace shearwake::neural;

static AfferentClass class_of(const std::string& name) {
    return name == "SA1"  ? AfferentClass::SA1
           : name == "RA" ? AfferentClass::RA
                          : AfferentClass::PC;
}

TEST_CASE("all 17 neurons fire at the same samples as in TouchSim", "[neural]") {
    const std::string stimulus =
        GENERATE("sine200_50um", "sine20_300um", "sine60_100um", "ramphold_1mm",
                 "sine200_50um_preindent", "sine200_50um_fs20k");
    const auto afferents = test::one_of_each_row();
    const auto spikes = respond(test::single_stimulus(stimulus), afferents, {});
    std::size_t compared = 0;
    for (const auto& row : test::csv_rows("single_afferents.csv")) {
        if (row[0] != stimulus) continue;
        const Afferent afferent{{}, class_of(row[1]), std::stoul(row[2])};
        const auto at = std::find(afferents.begin(), afferents.end(), afferent);
        CAPTURE(stimulus, row[1], row[2]);
        CHECK(spikes[static_cast<std::size_t>(at - afferents.begin())] == test::train(row[3]));
        ++compared;
    }
    CHECK(compared == 17);
}

TEST_CASE(
    "Pacinian afferents of a palm fire at the same samples as in TouchSim for carrier and envelope",
    "[neural][slow]") {
    const std::string modulation = GENERATE("unmod", "am200");
    const std::string trace =
        GENERATE("signed", "halfwave", "square", "envelope5k", "square_pad20ms");
    std::vector<Afferent> afferents;
    std::vector<std::string> numbers;
    for (const auto& row : test::csv_rows("palm_afferents.csv")) {
        numbers.push_back(row[0]);
        afferents.push_back(
            {{std::stod(row[1]), std::stod(row[2])}, AfferentClass::PC, std::stoul(row[3])});
    }
    const auto spikes = respond(test::palm_stimulus(modulation, trace), afferents, {});
    std::size_t compared = 0;
    for (const auto& row : test::csv_rows("palm_spikes.csv")) {
        if (row[0] != modulation || row[1] != trace) continue;
        CAPTURE(modulation, trace, row[2]);
        REQUIRE(row[2] == numbers.at(compared));
        CHECK(spikes[compared] == test::train(row[3]));
        ++compared;
    }
    CHECK(compared == 24);
}

TEST_CASE("spikes of an afferent with noise do not depend on the other afferents", "[neural]") {
    const PinStimulus stimulus = test::single_stimulus("sine60_100um");
    const auto afferents = test::one_of_each_row();
    const auto all = respond(stimulus, afferents, {.noise_key = 7});
    for (std::size_t i = 0; i < afferents.size(); ++i) {
        const auto alone = respond(stimulus, std::span(afferents).subspan(i, 1),
                                   {.noise_key = 7, .first_number = static_cast<std::uint32_t>(i)});
        CHECK(alone.at(0) == all[i]);
    }
    CHECK(respond(stimulus, afferents, {.noise_key = 8}) != all);
    CHECK(respond(stimulus, afferents, {}) != all);
}

TEST_CASE("wave is delayed by its path along the skin but static stress is immediate", "[neural]") {
    PinStimulus stimulus{.at_mm = {{}}, .radius_mm = 1.0, .rate_Hz = 5000.0};
    stimulus.indentation_mm = Lines(1, 200);
    for (std::size_t k = 10; k < 200; ++k)
        stimulus.indentation_mm.values[k] = 0.1;
    const PinSource source(stimulus);
    const std::vector<Afferent> there = {{{17.0, 0.0}, AfferentClass::SA1, 0}};
    const auto drive = [&](double way_mm) {
        return source.drive(there, [=](Vec2) { return std::vector{way_mm}; });
    };
    const auto first = [](const neural::Line& line) {
        std::size_t k = 0;
        while (k < line.size() && line[k][0] == 0.0)
            ++k;
        return k;
    };
    // The central difference of the step at sample 10 begins at sample 9; 16 mm take 2 ms, 40 mm 5
    // ms.
    const Drive straight = drive(17.0);
    CHECK(first(straight.static_MPa) == 10);
    CHECK(first(straight.dynamic_N_s_mm3) == 9 + 10);
    const Drive around = drive(41.0);
    CHECK(first(around.static_MPa) == 10);
    CHECK(first(around.dynamic_N_s_mm3) == 9 + 25);
    const Drive never = drive(std::numeric_limits<double>::infinity());
    CHECK(first(never.static_MPa) == 10);
    CHECK(first(never.dynamic_N_s_mm3) == 200);
}

} // namespace test_respond
