// SPDX-License-Identifier: BSD-3-Clause
#include "unit/config/jobs.hpp"

#include <array>
#include <random>

namespace test_job {

using namespace shearwake;
using namespace shearwake::test;

/// The example of the interface document, with a medium of layers only.
static std::string full_job() {
    std::string job(plain_job);
    for (const auto& [old, by] :
         {std::pair{"\"plain\"", "\"am-stm-frequency\"\ntitle = \"eta and IPR against "
                                 "amplitude-modulation frequency\""},
          {"fwhm_mm = 3.0 }", "fwhm_mm = 3.0 }\ncarrier = \"averaged\""},
          {"from_mm = [-14.0, 0.0], to_mm = [14.0", "from_mm = [-49.0, 0.0], to_mm = [49.0"},
          {"= 500.0", "= 200.0"},
          {"[96.0, 64.0]", "[192.0, 128.0]\nsponge_mm = 12.0"},
          {"duration_ms = 4.0", "duration_ms = 14.0"}})
        job = replaced(job, old, by);
    return job + R"([solver]
engine = "layered"
[measure]
at_ms = 14.0
settled_after_ms = 4.0
focal_radius_fwhm = 1.0
depths_mm = [0.0]
[record]
traces_mm = [[0.0, 0.0]]
snapshots_ms = [7.0, 14.0]
frames = false
[sweep]
"load.modulation.am_frequency_Hz" = [100, 200, 300, 400, 600, 800]
"load.footprint.fwhm_mm" = [2.0, 3.0, 6.0]
zip = [ { "load.modulation.speed_m_s" = [3, 5, 7], "domain.spacing_mm" = [1, 1, 0.75] } ]
exclude = [ { "load.footprint.fwhm_mm" = 2.0, "load.modulation.speed_m_s" = 3 } ]
[table]
x = "load.modulation.am_frequency_Hz"
series = ["load.footprint.fwhm_mm"]
reference = { kind = "STM" }
)";
}

/// Every value of `full_job` before its sweep, in SI, written by hand.
static Case full_case() {
    Case c;
    c.scene.medium.base = Base::rigid;
    c.scene.medium.layers = {{"tissue", 0.02, 1000.0, 1500.0, 5.0, KelvinVoigt{1.0}}};
    c.scene.load.peak_Pa = 100.0;
    c.scene.load.footprint = GaussianFootprint{0.003};
    c.scene.load.modulation = {"AM-STM",
                               {{Travel{{{-0.049, 0.0}, {0.049, 0.0}}, ConstantSpeed{7.0}}}},
                               {{SineGain{200.0}}}};
    c.domain = {256, 180, 0.00075, 0.012}; // 171 points make 180: 2 2 3 3 5
    c.time = {280, 5e-5};
    c.measure = {.at_s = 0.014, .settled_after_s = 0.004, .focal_radius_m = 0.003};
    c.record = {{{0.0, 0.0}}, {0.007, 0.014}, false};
    return c;
}

TEST_CASE("the example of the interface has the documented meaning", "[job]") {
    const std::string job = full_job(), unswept = job.substr(0, job.find("[sweep]"));
    CHECK(canonical_text(only_case(unswept)) == canonical_text(full_case()));
    CHECK(only_case(unswept) == full_case());
}

TEST_CASE("the example of the interface gives one case per combination that is not excluded",
          "[job]") {
    const config::Job job = config::read_job(full_job(), "job.toml");
    CHECK(job.text == full_job());
    CHECK(job.plan.name == "am-stm-frequency");
    CHECK(job.plan.title == "eta and IPR against amplitude-modulation frequency");
    CHECK(job.plan.swept_keys == Texts{"load.modulation.am_frequency_Hz", "load.footprint.fwhm_mm",
                                       "load.modulation.speed_m_s", "domain.spacing_mm"});
    CHECK(job.plan.table.x == "load.modulation.am_frequency_Hz");
    CHECK(job.plan.table.series == Texts{"load.footprint.fwhm_mm"});
    // 6 x 3 x 3 less 6 excluded, and a reference for each of the 8 that remain without frequency.
    CHECK(job.plan.cases.size() == 48 + 8);
    for (const config::Diagnostic& diagnostic : job.diagnostics)
        CHECK(diagnostic.severity == Severity::warning);
}

TEST_CASE("a plain job has one case and no diagnostics", "[job]") {
    const config::Job job = config::read_job(plain_job, "job.toml");
    REQUIRE(job.plan.cases.size() == 1);
    CHECK(job.plan.cases[0].settings.empty());
    CHECK(job.plan.cases[0].id == case_id(job.plan.cases[0].physics));
    CHECK(job.plan.cases[0].reference_id.empty());
    CHECK(job.diagnostics.empty());
    CHECK(job.plan.table == TableOptions{});
}

TEST_CASE("the order and notation of a job do not change its id", "[job]") {
    const std::string other = R"(
job.name = "other-name"
schema = 1
time = { output_interval_us = 50, duration_ms = 4 }
[load.modulation]
am_depth = 1
am_frequency_Hz = 5e2
mach = 1.4
kind = 'AM-STM'
[load.modulation.path]
to_mm = [14, 0]
from_mm = [-14, -0.0]
shape = "line"
[domain]
spacing_mm = 75e-2
extent_mm = [96, 64]
[load]
footprint.fwhm_mm = 3
footprint.shape = "gaussian"
carrier = "averaged"
peak_Pa = 1_00
[[medium.layer]]
loss = { viscosity_Pa_s = 1, law = "kelvin-voigt" }
c_s_m_s = 5
c_p_m_s = 1500
density_kg_m3 = 1000
thickness_mm = 20
name = "tissue"
[medium]
base = "rigid"
)";
    CHECK(canonical_text(only_case(other)) == canonical_text(only_case(plain_job)));
}

TEST_CASE("an error in [job] or schema is reported with its location", "[job]") {
    const auto [old, by, diagnostic] = GENERATE(table<std::string, std::string, std::string>({
        {"schema = 1\n", "", "job.toml: error: schema is missing; begin the job with the line"},
        {"schema = 1", "schema = 2", "1:10 schema must be 1, the only version that this program"},
        {"name = \"plain\"\n", "", "2:1 job.name is missing"},
        {"[job]\nname = \"plain\"\n", "", "job.toml: error: job is missing"},
        {"name =", "nam =", "3:1 job.nam is unknown; did you mean name?"},
        {"[load]", "[laod]\n[load]", "13:2 laod is unknown; did you mean load?"},
    }));
    check_only(diagnostics_of(plain_with(old, by)),
               diagnostic.starts_with("job") ? diagnostic : error_at(diagnostic));
}

TEST_CASE("invalid TOML is reported once with its location", "[job]") {
    const Texts found = diagnostics_of(plain_with("peak_Pa = 100.0", "peak_Pa = = 3"));
    REQUIRE(found.size() == 1);
    CHECK(found[0].starts_with("job.toml:14:11: error: this is not valid TOML: "));
    check_only(diagnostics_of("schema = 1\nload = {\n  peak_Pa = 1.0,\n}\n"),
               "write it on one line");
}

TEST_CASE("a duplicate key is reported with its line", "[job]") {
    const Texts found = diagnostics_of(plain_and("[sweep]\n\"load.peak_Pa\" = [1, 2]\n"
                                                 "\"load.peak_Pa\" = [3]\n"));
    REQUIRE(found.size() == 1);
    CHECK(found[0].find(": error: duplicate key: a table may contain a key only once") !=
          std::string::npos);
    const std::string text = plain_and("[sweep]\n\"load.peak_Pa\" = [1, 2]\n");
    const auto line = 1 + std::count(text.begin(), text.end(), '\n');
    CHECK(found[0].starts_with("job.toml:" + std::to_string(line) + ":"));
}

TEST_CASE("a name that leads outside the output directory is rejected", "[job]") {
    const std::string name =
        GENERATE(as<std::string>{}, "", ".", "..", "../x", "a/b", "a b", ".hidden", "-rf", "a\\\\b",
                 "\\u00e4", std::string(101, 'x'), "a\\u0000");
    const Texts found = diagnostics_of(plain_with("\"plain\"", "\"" + name + "\""));
    REQUIRE(found.size() >= 1);
    CHECK_THAT(found[0], Catch::StartsWith(
                             name == "a\\u0000"
                                 ? "job.toml:3:8: error: job.name contains a control character: "
                                   "\"a?\""
                                 : "job.toml:3:8: error: job.name must be a valid folder name"));
}

TEST_CASE("every missing table is reported at once", "[job]") {
    CHECK(diagnostics_of("schema = 1\n[job]\nname = \"x\"\n") ==
          Texts{"job.toml: error: [medium] is missing", "job.toml: error: [load] is missing",
                "job.toml: error: [domain] is missing", "job.toml: error: [time] is missing"});
}

TEST_CASE("all errors in a job are reported at once, in the order of the file", "[job]") {
    std::string text = plain_with("20.0", "-20.0");
    text = replaced(text, "peak_Pa = 100.0", "peak_Pa = \"much\"");
    text = replaced(text, "am_frequency_Hz", "am_frequncy_Hz");
    text = replaced(text, "spacing_mm = 0.75\n", "");
    CHECK(
        diagnostics_of(text) ==
        Texts{error_at(
                  "8:16 medium.layer[1].thickness_mm must be between 1e-09 and 10000, but is -20"),
              error_at("14:11 load.peak_Pa must be a number, but is a string (\"much\")"),
              error_at(
                  "20:1 load.modulation.am_frequncy_Hz is unknown; did you mean am_frequency_Hz?"),
              error_at("21:1 domain.spacing_mm is missing")});
}

TEST_CASE("an invalid job is a usage error with one diagnostic per line", "[job]") {
    std::string text(plain_job);
    for (int i = 0; i < 80; ++i)
        text += "unknown_" + std::to_string(i) + " = 1\n";
    try {
        config::read_job(text, "job.toml");
        FAIL("it was taken for a good job");
    } catch (const config::BadJob& bad) {
        const std::string what = bad.what();
        CHECK(bad.code() == ExitCode::bad_job);
        CHECK(bad.diagnostics().size() == 80);
        CHECK(std::count(what.begin(), what.end(), '\n') == 50);
        CHECK(what.ends_with("\nand 30 more"));
    }
}

TEST_CASE("an error is reported even after many warnings", "[job]") {
    std::string text = plain_and("[sweep]\n\"load.peak_Pa\" = [1, 2]\nexclude = [\n");
    for (int i = 0; i < 80; ++i)
        text += "{ \"load.peak_Pa\" = " + std::to_string(i + 3) + " },\n";
    text += "]\n[nonsense]\n";
    try {
        config::read_job(text, "job.toml");
        FAIL("it was taken for a good job");
    } catch (const config::BadJob& bad) {
        CHECK(std::string(bad.what()).find("nonsense is unknown") != std::string::npos);
    }
}

TEST_CASE("what is no TOML is rejected with one short message", "[job]") {
    const auto kind = GENERATE(range(std::size_t{0}, std::size_t{10}));
    std::mt19937 random(1);
    std::string text(1'000'000, '\0');
    for (char& c : text)
        c = static_cast<char>(kind == 0 ? random() % 256 : kind == 1 ? 32 + random() % 95 : 0);
    // Table headers that fail in builds of toml++ with assertions.
    if (kind > 2) text = std::array{"[ =", "[[[", "[#]", "[a.=]", "[", "[a", "[[a]"}.at(kind - 3);
    const Texts found = diagnostics_of(text);
    REQUIRE(found.size() == 1);
    CHECK(found[0].size() < 300);
    CHECK(found[0].starts_with("job.toml:1:"));
}

TEST_CASE("a text that is too long for a job is rejected without parsing", "[job]") {
    CHECK(diagnostics_of(std::string(10'000'000, '#')) ==
          Texts{"job.toml: error: the file has 10000000 bytes, but a job file may have at most "
                "2500000"});
}

TEST_CASE("excessive nesting is rejected", "[job]") {
    const auto repeated = [](int times, std::string_view part) {
        std::string text;
        for (int i = 0; i < times; ++i)
            text += part;
        return text;
    };
    const auto kind = GENERATE(range(std::size_t{0}, std::size_t{5}));
    const std::array texts = {
        "a = " + repeated(1'000'000, "["),                // lists
        "a = " + repeated(100'000, "{ a = "),             // tables
        "a" + repeated(500'000, " . \"b\".a") + " = 1",   // dotted keys
        "[a" + repeated(1'000'000, ".a") + "]",           // headers
        "a = " + repeated(200, "[") + repeated(200, "]"), // well-formed lists
    };
    CHECK(any_contains(diagnostics_of(texts.at(kind)), "error: "));
}

TEST_CASE("a long number, sentence or list is not treated as a long dotted key", "[job]") {
    std::string text(plain_job);
    text += "# ";
    for (int i = 0; i < 100; ++i)
        text += "e.g. 0.5 a.b. ";
    text += "\n[measure]\ndepths_mm = [0.0";
    for (int i = 1; i < 100; ++i)
        text += ",0." + std::to_string(100 + i);
    text += "]\n";
    CHECK(diagnostics_of(text).empty());
}

} // namespace test_job
