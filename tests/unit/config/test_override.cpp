// SPDX-License-Identifier: BSD-3-Clause
#include "unit/config/jobs.hpp"

namespace test_override {

using namespace shearwake;
using namespace shearwake::test;

TEST_CASE("an override replaces, adds and reaches into tables and layers", "[config][override]") {
    CHECK(only_case(plain_job, {{"load.peak_Pa", "300"}, {"load.peak_Pa", "200"}}) // the last wins
              .scene.load.peak_Pa == 200.0);
    CHECK(only_case(plain_job, {{"domain.sponge_mm", "1.5"}}).domain.sponge_m == 0.0015);
    CHECK(only_case(plain_job, {{"measure.at_ms", "3"}}).measure.at_s == Approx(0.003));
    CHECK(only_case(plain_job, {{"medium.layer[1].c_s_m_s", "4"}}).scene.medium.layers[0].c_s_m_s ==
          4.0);
    CHECK(only_case(plain_job, {{"record.traces_mm", "[[1, 2]]"}}).record.traces_m[0].y == 0.002);
    CHECK(config::read_job(plain_job, "job.toml",
                           std::vector<config::Override>{{"job.name", "other"}})
              .plan.name == "other");
}

TEST_CASE("a bare word is a string, and a quoted one too", "[config][override]") {
    const std::string value = GENERATE("pressure", "\"pressure\"", "'pressure'");
    const Case c = only_case(plain_job, {{"load.modulation.am_on", value}});
    CHECK(std::get<SineGain>(c.scene.load.modulation.envelope.gains[0]).on == GainOn::pressure);
}

TEST_CASE("an override can add and replace an axis", "[config][override]") {
    const std::string key = GENERATE("sweep.\"load.peak_Pa\"", "sweep.load.peak_Pa");
    const std::string more =
        GENERATE("", "[sweep]\n\"load.peak_Pa\" = [7, 8]\n", "[sweep]\nload.peak_Pa = [7, 8]\n");
    const Plan plan = config::read_job(plain_and(more), "job.toml",
                                       std::vector<config::Override>{{key, "[1, 2, 3]"}})
                          .plan;
    REQUIRE(plan.cases.size() == 3);
    CHECK(plan.cases[2].physics.scene.load.peak_Pa == 3.0);
}

TEST_CASE("the text of a job with overrides is the job that is computed", "[config][override]") {
    const std::string comment = "# SPDX-License-Identifier: X\n# Is it felt?\n";
    const std::string file =
        comment + plain_and("[sweep]\n\"load.modulation.am_frequency_Hz\" = [310, 620]\n"
                            "[table]\nx = \"load.modulation.am_frequency_Hz\"\n");
    const std::vector<config::Override> overrides = {
        {"load.peak_Pa", "87.5"},
        {"medium.layer[1].c_s_m_s", "3.25"},
        {"load.modulation.ramp_ms", "0.5"},
        {"job.title", R"("a \"quoted\" title")"},
        {R"(sweep."load.footprint.fwhm_mm")", "[4.5, 6]"}};
    const config::Job run = config::read_job(file, "job.toml", overrides);
    const config::Job again = config::read_job(run.text, "again.toml");
    REQUIRE(again.plan.cases.size() == 4);
    for (std::size_t i = 0; i < again.plan.cases.size(); ++i)
        CHECK(again.plan.cases[i].id == run.plan.cases[i].id);
    CHECK(run.text.starts_with(comment + "\n# job.toml with the values of the command line"));
    CHECK(again.plan.title == "a \"quoted\" title");
    CHECK_THAT(run.text, Catch::Contains("peak_Pa = 87.5 # -S; in the file: 100"));
    CHECK_THAT(run.text, Catch::Contains("c_s_m_s = 3.25 # -S; in the file: "));
    CHECK_THAT(run.text, Catch::Contains("ramp_ms = 0.5 # -S; not in the file"));
    CHECK_THAT(run.text, Catch::Contains("\"load.footprint.fwhm_mm\" = [4.5, 6] # -S; not in"));
    CHECK(config::read_job(file, "job.toml").text == file); // verbatim without overrides
}

TEST_CASE("an override of a swept key has no effect and is reported", "[config][override]") {
    const std::string sweep = GENERATE("load.peak_Pa = [1, 2]", "\"load.peak_Pa\" = [1, 2]",
                                       "zip = [ { load.peak_Pa = [1, 2] } ]");
    const std::string advice =
        sweep.starts_with("zip")
            ? "change its values in sweep.zip of the job file"
            : "to compute only this value, use -S 'sweep.\"load.peak_Pa\"=[7]'";
    CHECK(
        diagnostics_of(plain_and("[sweep]\n" + sweep), {{"load.peak_Pa", "7"}}) ==
        Texts{"-S load.peak_Pa: warning: load.peak_Pa is swept, so this override has no effect; " +
              advice});
    CHECK(diagnostics_of(plain_and("[sweep]\n" + sweep), {{"load.peak_Pa", "loud"}}) ==
          Texts{"-S load.peak_Pa: error: load.peak_Pa must be a number, like the values of its "
                "sweep, but is \"loud\""});
}

TEST_CASE("an override of a part of a swept table, of a table with a swept key and of an uncertain "
          "key has no effect and is reported",
          "[config][override]") {
    const auto with = [](const std::string& more, const config::Override& override) {
        return diagnostics_of(plain_and(more), {override});
    };
    const std::string gaussian = "{ shape = \"gaussian\", fwhm_mm = 6 }";
    const config::Override table{"load.footprint", gaussian}, part{"load.footprint.fwhm_mm", "5.5"};
    CHECK(with("[sweep]\n\"load.footprint.fwhm_mm\" = [4.5, 5]", table) ==
          Texts{"-S load.footprint: warning: load.footprint.fwhm_mm is swept, so this override has "
                "no effect on it; to compute only this value, use -S "
                "'sweep.\"load.footprint.fwhm_mm\"=[6]'"});
    CHECK(any_contains(
        with("[sweep]\nzip = [{ \"load.footprint\" = [" + gaussian + "] }]", part),
        "load.footprint is swept, so this override has no effect; change its values in sweep.zip"));
    CHECK(any_contains(
        with("[sweep]\n\"load.footprint\" = [" + gaussian + "]", part),
        "load.footprint is swept, so this override has no effect; change its values in [sweep]"));
    CHECK(any_contains(with("[uncertain]\nsamples = 8\n\"load.footprint.fwhm_mm\" = { distribution "
                            "= \"uniform\", min = 4, max = 6 }",
                            part),
                       "load.footprint.fwhm_mm is uncertain, so this override has no effect; "
                       "change its distribution in [uncertain]"));
    CHECK_FALSE(any_contains(with("[sweep]\n\"load.peak_Pa\" = [1, 2]", table), "has no effect"));
    CHECK_FALSE(any_contains(diagnostics_of(plain_and("[sweep]\n\"load.peak_Pa\" = [1, 2]"),
                                            {{"load.peak_Pa", "7"}, {"sweep", "{}"}}),
                             "has no effect"));
}

TEST_CASE("keys of other kinds are ignored if an override replaces the sweep of the kind",
          "[config][override]") {
    const std::string sweep = "[sweep]\n\"load.modulation.kind\" = [\"STM\", \"AM-STM\"]\n";
    const std::vector<config::Override> one = {{"sweep", "{}"},
                                               {"load.modulation.kind", "STM"},
                                               {"load.modulation.am_frequency_Hz", "200"}};
    CHECK_FALSE(any_contains(diagnostics_of(plain_and(sweep), one), "error"));
    CHECK(any_contains(diagnostics_of(plain_and(""), one),
                       "load.modulation.am_frequency_Hz does not apply to kind STM"));
}

TEST_CASE("an error in an override quotes the override", "[config][override]") {
    const auto [key, value, message] = GENERATE(table<std::string, std::string, std::string>({
        {"load.peek_Pa", "3", "load.peek_Pa is unknown; did you mean peak_Pa?"},
        {"peak_Pa", "3", "peak_Pa is unknown; did you mean load.peak_Pa?"},
        {"modulation.speed_m_s", "3",
         "modulation.speed_m_s is unknown; did you mean load.modulation.speed_m_s?"},
        {"density_kg_m3", "3",
         "density_kg_m3 is unknown; did you mean medium.layer[1].density_kg_m3 or "
         "medium.body[1].density_kg_m3?"},
        {"flux", "3", "flux is unknown; give keys with their tables, as in load.peak_Pa"},
        {"load.peak_Pa", "[", "\"[\" is not a valid TOML value, such as 0.5, [1, 2] or \"word\""},
        {"load.peak_Pa", "7\nfoo = 3", "\"7?foo = 3\" is not a valid TOML value, such as 0.5"},
        {"load.peak_Pa", "much", "load.peak_Pa must be a number, but is a string (\"much\")"},
        {"domain.extent_mm", "60,60", "write lists in brackets: [60,60] instead of 60,60"},
        {"measure.depths_mm", "0,1,2", "write lists in brackets: [0,1,2] instead of 0,1,2"},
        {"measure.depths_mm", "0,1",
         "write decimal numbers with a point: 0.1 instead of 0,1; lists are written in brackets"},
        {"receptors.where", "hand", "receptors is unknown; did you mean [afferents]?"},
        {"load..x", "3", "this is not a valid key; give it in full, as in -S load.peak_Pa=200"},
        {"load.peak_Pa.x", "3", "peak_Pa is a number, not a table"},
        {"medium.layer[2].c_s_m_s", "3", "the list has 1 entries, counted from 1"},
    }));
    check_only(diagnostics_of(plain_job, {{key, value}}), "-S " + key + ": error: " + message);
}

} // namespace test_override
