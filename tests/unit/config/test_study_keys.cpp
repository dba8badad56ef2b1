// SPDX-License-Identifier: BSD-3-Clause
#include "unit/config/jobs.hpp"

namespace test_study_keys {

using namespace shearwake;
using namespace shearwake::test;

namespace {

/// A uniform study on the domain of the job, with one source; `step_s` is its time step.
StudyData study_of(double step_s) {
    StudyData study{.content_hash = "0123456789abcdef",
                    .points = {128, 90, 16},
                    .spacing_m = {0.75e-3, 0.75e-3, 0.75e-3},
                    .time_step_s = step_s,
                    .steps = 400,
                    .density_kg_m3 = {1000.0},
                    .c_p_m_s = {20.0},
                    .c_s_m_s = {5.0}};
    return study;
}

constexpr std::string_view study_job = "[solver]\nengine = \"pstd\"\npstd = { study = \"s.h5\" }\n";

Texts said(std::string_view job, std::vector<config::Override> overrides = {},
           double step_s = 1e-5) {
    const auto load = [&](const std::string&) {
        return std::make_shared<const StudyData>(study_of(step_s));
    };
    Texts texts;
    try {
        for (const auto& d :
             config::read_job(job, "job.toml", overrides, nullptr, nullptr, load).diagnostics)
            texts.push_back(config::text(d));
    } catch (const config::BadJob& bad) {
        for (const auto& d : bad.diagnostics())
            texts.push_back(config::text(d));
    }
    return texts;
}

} // namespace

TEST_CASE("a study can be swept in the keys that it does not replace", "[config][study]") {
    CHECK(said(plain_and(study_job)) == Texts{});
    CHECK(said(plain_and(study_job), {{"measure.at_ms", "3"}}) == Texts{});
    CHECK(said(plain_and(std::string(study_job) + "[sweep]\n\"measure.at_ms\" = [2, 3]\n")) ==
          Texts{});
}

TEST_CASE("overrides and sweeps of the medium and the load of a study are rejected",
          "[config][study]") {
    const std::string key = GENERATE("load.peak_Pa", "medium.layer[1].c_s_m_s");
    const Texts override = said(plain_and(study_job), {{key, "4"}});
    REQUIRE(override.size() == 1);
    CHECK(override[0].starts_with("-S " + key + ": error: " + key +
                                  " has no effect on the imported simulation"));
    const Texts swept =
        said(plain_and(std::string(study_job) + "[sweep]\n\"" + key + "\" = [4, 4.5]\n"));
    CAPTURE(swept);
    REQUIRE(swept.size() == 1);
    CHECK(swept[0].starts_with("job.toml:31:1: error: sweep: " + key +
                               " has no effect on the imported simulation"));
    CHECK(any_contains(said(plain_and(study_job), {{"sweep.\"" + key + "\"", "[4, 4.5]"}}),
                       "sweep: " + key + " has no effect on the imported simulation"));
    CHECK(said(plain_job, {{key, "4"}}) == Texts{});
}

TEST_CASE("another engine does not ignore a study", "[config][study]") {
    const std::string engine = GENERATE("layered", "spectral");
    const Texts texts = said(plain_and(study_job), {{"solver.engine", engine}});
    REQUIRE(texts.size() == 1);
    CHECK(texts[0] == "-S solver.engine: error: solver.engine is \"" + engine +
                          "\", but only \"pstd\" computes the imported simulation of "
                          "solver.pstd.study; to repeat it with \"" +
                          engine +
                          "\", describe its medium and its load in a job without this key "
                          "(docs/how-to/kwave.md)");
    CHECK(any_contains(said(plain_and(std::string(study_job) +
                                      "[sweep]\n\"solver.engine\" = [\"pstd\", \"layered\"]\n")),
                       "only \"pstd\" computes the imported simulation"));
}

TEST_CASE("the time step of a study is checked before the run", "[config][study]") {
    // dt c_p K <= 2 with K = sqrt(3) pi/d: 13.78 us
    CHECK(said(plain_and(study_job), {{"time.output_interval_us", "60"}, {"time.duration_ms", "3"}},
               12e-6) == Texts{});
    const Texts unstable =
        said(plain_and(study_job), {{"time.output_interval_us", "60"}, {"time.duration_ms", "3"}},
             15e-6);
    REQUIRE(unstable.size() == 1);
    CAPTURE(unstable);
    CHECK(any_contains(unstable,
                       "error: solver.pstd.study: has a time step of 15 us (kgrid.dt in "
                       "k-Wave), which is unstable in this medium: steps up to 13.7832 us"));
}

} // namespace test_study_keys
