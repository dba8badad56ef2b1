// SPDX-License-Identifier: BSD-3-Clause
#include "unit/config/jobs.hpp"

#include <set>

namespace test_sweep {

using namespace shearwake;
using namespace shearwake::test;

static Plan plan_of(std::string_view more, std::vector<config::Override> overrides = {}) {
    return config::read_job(plain_and(more), "job.toml", overrides).plan;
}

/// The values of one swept key, case after case.
static std::vector<double> numbers(const Plan& plan, std::string_view key) {
    std::vector<double> values;
    for (const PlannedCase& c : plan.cases)
        for (const Setting& setting : c.settings)
            if (setting.key == key) values.push_back(std::get<double>(setting.value));
    return values;
}

static std::vector<double> peaks(std::string_view values) {
    return numbers(plan_of("[sweep]\n\"load.peak_Pa\" = " + std::string(values)), "load.peak_Pa");
}

TEST_CASE("axes multiply, the first slowest and the last fastest", "[config][sweep]") {
    const Plan plan = plan_of("[sweep]\n\"load.peak_Pa\" = [100, 200]\n"
                              "\"load.modulation.am_frequency_Hz\" = [700, 500, 600]\n");
    CHECK(numbers(plan, "load.peak_Pa") == std::vector<double>{100, 100, 100, 200, 200, 200});
    CHECK(numbers(plan, "load.modulation.am_frequency_Hz") ==
          std::vector<double>{700, 500, 600, 700, 500, 600});
    CHECK(plan.cases[3].physics.scene.load.peak_Pa == 200.0);
    CHECK(modulation_frequency_Hz(plan.cases[4].physics.scene.load.modulation) == 500.0);
    std::set<std::string> ids;
    for (const PlannedCase& c : plan.cases) {
        CHECK(c.id == case_id(c.physics));
        ids.insert(c.id);
    }
    CHECK(ids.size() == 6);
}

TEST_CASE("a case of a sweep equals the same case without a sweep", "[config][sweep]") {
    const Plan plan = plan_of("[sweep]\n\"load.footprint.fwhm_mm\" = [3.0, 4.0]\n");
    CHECK(plan.cases[0].physics == only_case(plain_job));
    CHECK(plan.cases[1].physics == only_case(plain_with("fwhm_mm = 3.0", "fwhm_mm = 4.0")));
}

TEST_CASE("axes keep the order of the file, independent of how their dots are written",
          "[config][sweep]") {
    const Plan plan = plan_of(R"([sweep]
load.peak_Pa = [1, 2]
"domain.spacing_mm" = [0.75, 0.5]
load.footprint.fwhm_mm = [3, 4]
[sweep.load.modulation]
am_frequency_Hz = [500, 600]
)");
    CHECK(plan.swept_keys == Texts{"load.peak_Pa", "domain.spacing_mm", "load.footprint.fwhm_mm",
                                   "load.modulation.am_frequency_Hz"});
    CHECK(plan.cases.size() == 16);
}

TEST_CASE("generators give the expected values", "[config][sweep]") {
    CHECK(peaks("{ linspace = [0.1, 1, 10] }") ==
          std::vector{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0});
    CHECK(peaks("{ linspace = [5, 1, 3] }") == std::vector{5.0, 3.0, 1.0});
    CHECK(peaks("{ logspace = [1, 1000, 4] }") == std::vector{1.0, 10.0, 100.0, 1000.0});
    CHECK(peaks("{ range = [50, 200, 50] }") == std::vector{50.0, 100.0, 150.0, 200.0});
    CHECK(peaks("{ range = [50, 199, 50] }") == std::vector{50.0, 100.0, 150.0});
    CHECK(peaks("{ range = [0.1, 0.5, 0.1] }") == std::vector{0.1, 0.2, 0.3, 0.4, 0.5});
    CHECK(peaks("{ range = [3, 1, -1] }") == std::vector{3.0, 2.0, 1.0});
    CHECK(peaks("{ range = [3, 3, 1] }") == std::vector{3.0});
}

TEST_CASE("zipped keys change together and are combined with the other axes", "[config][sweep]") {
    const Plan plan = plan_of(
        "[sweep]\n\"load.peak_Pa\" = [1, 2]\n"
        "zip = [ { \"load.modulation.speed_m_s\" = [7, 8], domain.spacing_mm = [0.75, 0.5] } ]\n");
    CHECK(plan.swept_keys ==
          Texts{"load.peak_Pa", "load.modulation.speed_m_s", "domain.spacing_mm"});
    CHECK(numbers(plan, "load.modulation.speed_m_s") == std::vector<double>{7, 8, 7, 8});
    CHECK(numbers(plan, "domain.spacing_mm") == std::vector{0.75, 0.5, 0.75, 0.5});
}

TEST_CASE("a zipped key may contain a value twice if the combinations differ", "[config][sweep]") {
    CHECK(plan_of("[sweep]\nzip = [ { load.peak_Pa = [1, 1], domain.spacing_mm = [0.75, 0.5] } ]")
              .cases.size() == 2);
}

TEST_CASE("an excluded combination gives no case", "[config][sweep]") {
    const Plan plan =
        plan_of("[sweep]\n\"load.peak_Pa\" = [1, 2]\n\"domain.spacing_mm\" = [0.5, 0.75]\nexclude "
                "= [ { \"load.peak_Pa\" = 2.0, domain.spacing_mm = 0.5 } ]\n");
    CHECK(numbers(plan, "load.peak_Pa") == std::vector<double>{1, 1, 2});
}

TEST_CASE("points, layers, words and tables can be swept", "[config][sweep]") {
    const Plan plan = plan_of(R"([sweep]
"load.modulation.path.from_mm" = [[-14, 0], [-15, 0]]
"medium.layer[1].c_s_m_s" = [5, 4.5]
"load.modulation.am_on" = ["force", "pressure"]
"load.footprint" = [{ shape = "gaussian", fwhm_mm = 3 }]
"record.frames" = [false]
)");
    REQUIRE(plan.cases.size() == 8);
    const PlannedCase& last = plan.cases.back();
    CHECK(std::get<Line>(
              std::get<Travel>(last.physics.scene.load.modulation.trajectory.parts[0]).path.shape)
              .from_m.x == -0.015);
    CHECK(last.physics.scene.medium.layers[0].c_s_m_s == 4.5);
    using Value = decltype(Setting::value);
    CHECK(last.settings[0].value == Value("[-15, 0]"));
    CHECK(last.settings[2].value == Value("pressure"));
    CHECK(last.settings[3].value == Value("{ shape = \"gaussian\", fwhm_mm = 3 }"));
    CHECK(last.settings[4].value == Value("false"));
}

TEST_CASE("a sweep can change the layers of a preset", "[config][sweep]") {
    const std::string job = with_medium("[medium]\npreset = \"three-layer-skin\"\n") + "[sweep]\n";
    CHECK(config::read_job(job + "\"medium.layer[2].thickness_mm\" = [1, 2]\n", "job.toml")
              .plan.cases[0]
              .physics.scene.medium.layers[1]
              .thickness_m == 0.001);
    CHECK(config::read_job(job + "\"medium.preset\" = [\"ecoflex\", \"forearm\"]\n", "job.toml")
              .plan.cases[1]
              .physics.scene.medium.layers[0]
              .name == "forearm");
}

TEST_CASE("with a swept kind, each kind ignores the keys of other kinds", "[config][sweep]") {
    const Plan plan = plan_of("[sweep]\n\"load.modulation.kind\" = [\"STM\", \"AM-STM\"]\n");
    REQUIRE(plan.cases.size() == 2);
    CHECK(plan.cases[0].physics.scene.load.modulation.envelope.gains.empty());
    CHECK(plan.cases[1].physics.scene.load.modulation.envelope.gains.size() == 1);
}

TEST_CASE("a required key may be given only in the sweep", "[config][sweep]") {
    const std::string job = plain_with("peak_Pa = 100.0\n", "");
    CHECK(diagnostics_of(job + "[sweep]\n\"load.peak_Pa\" = [1, 2]\n").empty());
}

TEST_CASE("an error in a sweep is reported with its location", "[config][sweep]") {
    const auto [more, diagnostic] = GENERATE(table<std::string, std::string>({
        {"\"load.peak_Pa\" = []", "28:18 load.peak_Pa has no values; an axis must have at least"},
        {"\"load.peek_Pa\" = [1, 2]", "28:1 load.peek_Pa is unknown; did you mean peak_Pa?"},
        {"\"load.peak_Pa\" = [1, 2, 1.0]", "28:25 sweep: load.peak_Pa contains the value 1 twice"},
        {"\"load.peak_Pa\" = 3", "28:18 load.peak_Pa must be a list of values, or a table"},
        {"\"load.peak_Pa\" = [1, 2]\nload.peak_Pa = [3]",
         "29:6 sweep: load.peak_Pa is swept twice"},
        {"\"load.peak_Pa\" = [1, 2]\nzip = [ { load.peak_Pa = [3] } ]",
         "29:16 sweep: load.peak_Pa is swept twice"},
        {"zip = [ { load.peak_Pa = [3, 4], load.modulation.speed_m_s = [7] } ]",
         "28:50 sweep.zip: load.peak_Pa has 2 values and load.modulation.speed_m_s has 1; keys"},
        {"zip = [ { load.peak_Pa = [3, 3], domain.spacing_mm = [0.5, 0.5] } ]",
         "28:30 sweep: load.peak_Pa contains the value 3,0.5 twice"},
        {"\"job.name\" = [\"a\"]", "28:1 sweep: \"job.name\" is not a key of a case; the key"},
        {"\"load.peak_Pa\" = { linspace = [1, 2] }", "28:31 load.peak_Pa: linspace requires"},
        {"\"load.peak_Pa\" = { linspace = [1, 2, 1e12] }",
         "28:31 load.peak_Pa: linspace requires a count from 2 to 10000 as its third number, which "
         "is 1e+12"},
        {"\"load.peak_Pa\" = { range = [-1e308, 1e308, 1] }",
         "28:28 load.peak_Pa: range has too many values; at most 10000 are supported"},
        {"\"load.peak_Pa\" = { logspace = [0, 2, 3] }", "28:31 load.peak_Pa: logspace requires"},
        {"\"load.peak_Pa\" = { range = [0, 2, -3] }", "28:28 load.peak_Pa: range requires a step"},
        {"\"load.peak_Pa\" = { range = [1, 400, 1] }\n\"domain.spacing_mm\" = { range = [1, 400, "
         "1] }",
         "27:1 sweep results in 160000 cases; at most 10000 are supported: divide it into several "
         "jobs"},
        {"\"load.peak_Pa\" = [1, 2]\nexclude = [ { load.peek_Pa = 3 } ]",
         "29:20 sweep.exclude: load.peek_Pa is not swept; did you mean load.peak_Pa?"},
        {"\"load.peak_Pa\" = [1, 2]\nexclude = [ { load.peak_Pa = 1 }, { load.peak_Pa = 2 } ]",
         "27:1 sweep.exclude removes all cases"},
        {"\"load.peak_Pa\" = [1, 2]\nexclude = [ { load.peak_Pa = 3 } ]",
         "job.toml:29:13: warning: sweep.exclude: this entry matches no case and has no effect"},
        {"\"medium.layer[2].c_s_m_s\" = [4, 5]", "28:1 sweep: medium.layer[2].c_s_m_s does not "
                                                 "exist: the list has 1 entries, counted from 1"},
        {"\"load.peak_Pa.x\" = [4, 5]",
         "28:1 sweep: load.peak_Pa.x does not exist: peak_Pa is a number, not a table"},
        {"\"load.modulation.sm_phase_deg\" = [0, 90]",
         "28:35 load.modulation.sm_phase_deg does not apply to kind AM-STM"},
    }));
    const Texts found = diagnostics_of(plain_and("[sweep]\n" + more + "\n"));
    CAPTURE(found);
    const bool is_warning = diagnostic.starts_with("job"); // with its place
    CHECK(any_contains(found, is_warning ? diagnostic : error_at(diagnostic)));
    CHECK(found.size() <= 2);
}

TEST_CASE("every invalid value of an axis is reported once", "[config][sweep]") {
    CHECK(diagnostics_of(plain_and("[sweep]\n\"load.peak_Pa\" = [1, \"a\", -1]\n"
                                   "\"domain.spacing_mm\" = [0.5, 0.75]\n")) ==
          Texts{error_at("28:22 load.peak_Pa must be a number, but is a string (\"a\")"),
                error_at("28:27 load.peak_Pa must be above 0, but is -1")});
}

TEST_CASE("keys that exclude each other are reported once for all values of an axis",
          "[config][sweep]") {
    CHECK(diagnostics_of(plain_and("[sweep]\n\"load.modulation.mach\" = [1.2, 1.4, 1.6]\n")) ==
          Texts{error_at("28:27 load.modulation.mach and speed_m_s are both given; remove one of "
                         "them from the job")});
}

TEST_CASE("two combinations that give the same case are reported", "[config][sweep]") {
    const Texts found = diagnostics_of(plain_and("[sweep]\nload.modulation.kind = [\"STM\"]\n"
                                                 "load.modulation.am_frequency_Hz = [500, 600]\n"));
    CHECK(found == Texts{"job.toml:27:1: error: sweep: two combinations of values describe the "
                         "same case: { load.modulation.kind = STM, load.modulation.am_frequency_Hz "
                         "= 500 } and { load.modulation.kind = STM, "
                         "load.modulation.am_frequency_Hz = 600 }; exclude one of them"});
}

TEST_CASE("a remark on several cases is reported once with a count", "[config][sweep]") {
    CHECK(diagnostics_of(plain_and("[sweep]\n\"domain.spacing_mm\" = [0.75, 1.2, 1.25, 1.3]\n")) ==
          Texts{"job.toml:28:1: warning: domain.spacing_mm: the focus is 3 mm wide (FWHM) and the "
                "spacing is 1.2 mm, which gives 2.5 points per width: the spectrum of the focus "
                "still has 0.0038 of its peak at the shortest shear wave that the grid represents; "
                "use 1 mm (and 2 more cases)"});
    CHECK(diagnostics_of(
              plain_and("[sweep]\nload.peak_Pa = [1, 2]\n[measure]\nfocal_radius_mm = 0.5\n")) ==
          Texts{"job.toml:30:1: warning: measure.focal_radius_mm: the radius of the focal disc, "
                "0.5 mm, is below the spacing of 0.75 mm: the disc contains only one or two "
                "samples (and 1 more case)"});
}

TEST_CASE("the case that needs the largest domain is reported first", "[config][sweep]") {
    // Waves of 5 m/s travel 30 mm in 6 ms and return through the edges of a domain of 32 mm.
    std::string job = plain_and("[sweep]\n\"time.duration_ms\" = [8, 16, 12]\n");
    job = replaced(job, "extent_mm = [96.0, 64.0]", "extent_mm = [64.0, 48.0]");
    Texts returning;
    for (const std::string& text : diagnostics_of(job))
        if (text.find("return through the opposite one") != std::string::npos)
            returning.push_back(text);
    REQUIRE(returning.size() == 1);
    CHECK(returning[0].find("before the run ends at 16 ms") != std::string::npos);
    CHECK(returning[0].ends_with("(and 2 more cases)"));
}

TEST_CASE("a sweep with too many keys is rejected without expansion", "[config][sweep]") {
    std::string more = "[sweep]\n";
    for (int i = 0; i < 20000; ++i)
        more += "load.k" + std::to_string(i) + " = [1]\n";
    CHECK(diagnostics_of(plain_and(more)) ==
          Texts{"job.toml:27:1: error: sweep has 20000 keys; at most 50 are supported"});
}

} // namespace test_sweep
