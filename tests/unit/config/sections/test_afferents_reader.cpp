// SPDX-License-Identifier: BSD-3-Clause
#include "config/files/files.hpp"
#include "config/job.hpp"
#include "unit/config/jobs.hpp"

namespace test_afferents_reader {

using namespace shearwake;
using namespace shearwake::test;

static AfferentOptions options_of(std::string_view text,
                                  const config::TextLoader& files = nullptr) {
    return config::read_afferent_options("[afferents]\n" + std::string(text), "options", {}, files);
}

static std::string refusal(std::string_view text, const config::TextLoader& files = nullptr) {
    try {
        options_of(text, files);
    } catch (const config::BadJob& bad) {
        return bad.what();
    }
    return "";
}

TEST_CASE("a job without [afferents] keeps its case id", "[config][afferents]") {
    CHECK_FALSE(only_case(plain_job).afferents.has_value());
    CHECK_THAT(canonical_text(only_case(plain_job)), !Catch::Contains("afferents"));
    const Case c = only_case(plain_and("[afferents]\n"));
    REQUIRE(c.afferents.has_value());
    AfferentOptions defaults;
    defaults.pins_m = c.afferents->pins_m; // on the path
    CHECK(*c.afferents == defaults);
    CHECK(case_id(c) != case_id(only_case(plain_job)));
}

TEST_CASE("pins that are not given follow the path, or the foci, or lie at the origin",
          "[config][afferents]") {
    const auto pins_of = [](const std::string& job) { return only_case(job).afferents->pins_m; };
    // A line of 28 mm and an FWHM of 3 mm: ten intervals, at most one FWHM long.
    const auto line = pins_of(plain_and("[afferents]\n"));
    REQUIRE(line.size() == 11);
    for (std::size_t i = 0; i < line.size(); ++i) {
        CHECK(line[i].x == Approx(-0.014 + 0.0028 * static_cast<double>(i)).margin(1e-12));
        CHECK(line[i].y == Approx(0.0).margin(1e-12));
    }
    // A circle has no pin twice, although its path ends where it begins.
    const auto circle = pins_of(replaced(plain_and("[afferents]\n"),
                                         R"("line", from_mm = [-14.0, 0.0], to_mm = [14.0, 0.0])",
                                         R"("circle", radius_mm = 10.0)"));
    CHECK(circle.size() == 21); // 62.8 mm in steps of at most 3 mm
    for (const Vec2 pin : circle)
        CHECK(norm(pin) == Approx(0.01).epsilon(1e-9));
    for (std::size_t i = 0; i < circle.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            CHECK(norm(circle[i] - circle[j]) > 0.002); // two radii of a pin
    CHECK(pins_of(
              plain_and("[afferents]\ncarrier = { amplitude_um = 10.0 }\ninput = \"carrier\"\n")) ==
          std::vector<Vec2>{{}});
    CHECK(pins_of(plain_and("[afferents]\ninput = \"stress\"\n[solver]\nengine = \"layered\"\n")) ==
          std::vector<Vec2>{{}});
    CHECK(pins_of(plain_and("[afferents]\npins_mm = [[3, 4]]\n")) ==
          std::vector<Vec2>{{0.003, 0.004}});
}

TEST_CASE("afferents are read in millimetres", "[config][afferents]") {
    const AfferentOptions o = options_of(R"(where = "fingertip"
digit = 3
classes = ["PC", "SA1"]
seed = 7
patch_mm = [10, -20]
patch_deg = 90
pins_mm = [[0, 0], [1.5, 0]]
pin_radius_mm = 0.5
silence_ms = 5
noise = true
conduction_delay = true
)");
    CHECK(o.places == AfferentPlaces(HandAfferents{"fingertip", 3}));
    CHECK(o.classes == std::vector{AfferentClass::SA1, AfferentClass::PC});
    CHECK(o.seed == 7);
    CHECK(o.patch_m == Vec2{0.01, -0.02});
    CHECK(o.patch_rad == Approx(M_PI / 2).epsilon(1e-15));
    CHECK(o.pins_m == std::vector<Vec2>{{}, {0.0015, 0.0}});
    CHECK(o.pin_radius_m == 0.0005);
    CHECK(o.silence_s == 0.005);
    CHECK(o.noise == Switch::on);
    CHECK(o.conduction_delay == Switch::on);
    CHECK(o.sheet == SkinSheet::hand);
}

TEST_CASE("pins can be given as a line or a grid", "[config][afferents]") {
    CHECK(options_of("pin_line = { from_mm = [-2, 0], to_mm = [2, 0], count = 3 }").pins_m ==
          std::vector<Vec2>{{-0.002, 0.0}, {}, {0.002, 0.0}});
    const auto grid = options_of("pin_grid = { extent_mm = [4, 2], pitch_mm = 2 }").pins_m;
    CHECK(grid.size() == 3);                           // 2 mm along y leave one row
    CHECK_THAT(refusal("pin_grid = { pitch_mm = 2 }"), // only what is missing
               Catch::Contains("extent_mm is missing") && !Catch::Contains("results in"));
}

TEST_CASE("a line with one pin is reported once and not as a position", "[config][afferents]") {
    check_only(diagnostics_of(plain_and(
                   "[afferents]\npin_line = { from_mm = [-2, 0], to_mm = [2, 0], count = 1 }\n")),
               "pin_line.count must be between 2 and 1000");
}

TEST_CASE("pins outside the domain are rejected", "[config][afferents]") {
    CHECK_THAT(
        diagnostics_of(plain_and("[afferents]\npins_mm = [[0, 0], [60, 0]]\n")).at(0),
        Catch::Contains("afferents.pins_mm must lie inside the domain, within 48 and 33.75 mm") &&
            Catch::Contains("[60, 0] does not"));
}

TEST_CASE("the default skin for a grid of afferents is flat", "[config][afferents]") {
    const AfferentOptions o = options_of("where = \"grid\"\nextent_mm = [10, 20]\npitch_mm = 2\n");
    CHECK(o.places == AfferentPlaces(GridAfferents{{0.01, 0.02}, 0.002}));
    CHECK(o.sheet == SkinSheet::flat);
}

TEST_CASE("afferents come from a CSV file", "[config][afferents]") {
    const auto file = [](const std::string&) {
        return std::string("# mine\nx_mm,y_mm,class,row\n1, 2,PC,3\n-4,5,RA,8\n");
    };
    const AfferentOptions o = options_of("where = \"csv\"\nfile = \"a.csv\"", file);
    CHECK(o.places == AfferentPlaces(AfferentList{{{{0.001, 0.002}, AfferentClass::PC, 3},
                                                   {{-0.004, 0.005}, AfferentClass::RA, 8}}}));
    const auto [csv, said] = GENERATE(table<std::string, std::string>({
        {"x_mm,y_mm,class,row\n1,2,PC,4\n", "line 2"},
        {"x_mm,y_mm,class,row\n1,2,PC,4\n", "1,2,PC,4"},
        {"x,y\n1,2\n", "x_mm,y_mm,class,row"},
        {"x_mm,y_mm,class,row\n", "must contain at least one afferent"},
    }));
    CHECK_THAT(config::read_listed_afferents(csv).problem, Catch::Contains(said));
}

TEST_CASE("the sampling rate of a carrier must resolve it", "[config][afferents]") {
    const AfferentOptions o =
        options_of("input = \"carrier\"\ncarrier = { amplitude_um = 50, am_frequency_Hz = 200 }");
    const auto& carrier = std::get<CarrierInput>(o.input);
    CHECK(carrier == CarrierInput{.wave = CarrierWave::squared,
                                  .frequency_Hz = 40e3,
                                  .amplitude_m = 50e-6,
                                  .sampling_Hz = 200e3,
                                  .am_frequency_Hz = 200.0,
                                  .am_depth = 1.0});
}

TEST_CASE("errors in [afferents] name the key", "[config][afferents]") {
    const auto [text, said] = GENERATE(table<std::string, std::string>({
        {"classes = [\"SA2\"]", "but contains \"SA2\""},
        {"where = \"plam\"", "did you mean \"palm\"?"},
        {"nois = true", "did you mean noise?"},
        {"extent_mm = [10, 20]", "only with where = \"grid\""},
        {"carrier = { amplitude_um = 50 }", "only with input = \"carrier\""},
        {"input = \"carrier\"\ncarrier = { amplitude_um = 50, am_depth = 1 }",
         "am_depth requires am_frequency_Hz"},
        {"input = \"carrier\"\ncarrier = { amplitude_um = 50, sampling_kHz = 10 }",
         "0.25 samples per cycle of 40 kHz"},
        {"input = \"carrier\"\ncarrier = { amplitude_um = 50, sampling_kHz = 10 }", "at least 200"},
        {"pin_grid = { extent_mm = [100, 100], pitch_mm = 1 }",
         "results in 10201 pins; at most 1000"},
        {"pins_mm = [[0, 0]]\npin_grid = { extent_mm = [4, 2], pitch_mm = 2 }",
         "pins_mm cannot be combined with pin_line or pin_grid"},
    }));
    CHECK_THAT(refusal(text), Catch::Contains(said));
}

} // namespace test_afferents_reader
