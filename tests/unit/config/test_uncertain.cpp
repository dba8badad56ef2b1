// SPDX-License-Identifier: BSD-3-Clause
#include "sampling/design.hpp"
#include "unit/config/jobs.hpp"

#include <algorithm>
#include <set>

namespace test_uncertain {

using namespace shearwake;
using namespace shearwake::test;

constexpr std::string_view two_keys = R"([uncertain]
samples = 16
"medium.layer[1].c_s_m_s" = { distribution = "normal", mean = 5.0, sd = 0.5, min = 4.0, max = 6.0 }
"medium.layer[1].viscosity_Pa_s" = { distribution = "lognormal", median = 1.0, geometric_sd = 1.2 }
)";

static Plan plan_of(std::string_view more, std::vector<config::Override> overrides = {}) {
    return config::read_job(plain_and(more), "job.toml", overrides).plan;
}

static std::set<std::string> ids(const Plan& plan) {
    std::set<std::string> found;
    for (const PlannedCase& c : plan.cases)
        found.insert(c.id);
    return found;
}

/// The diagnostics of a job with one uncertain key, whose values follow.
static Texts of_speed(const std::string& distribution, const std::string& more = "samples = 16") {
    return diagnostics_of(
        plain_and("[uncertain]\n" + more + "\n\"medium.layer[1].c_s_m_s\" = " + distribution));
}

const std::string observed =
    plain_and("[uncertain]\nsamples = 8\n\"load.peak_Pa\" = { distribution "
              "= \"csv\", file = \"p.csv\", column = \"p\" }\n");

TEST_CASE("a sample is the last axis of a sweep", "[config][uncertain]") {
    const Plan plan = plan_of("[sweep]\nload.peak_Pa = [50, 100]\n" + std::string(two_keys));
    REQUIRE(plan.cases.size() == 32);
    CHECK(ids(plan).size() == 32);
    REQUIRE(plan.uncertain);
    CHECK(plan.uncertain->keys.size() == 2);
    CHECK(plan.swept_keys.size() == 3);
    CHECK(plan.table.x == "load.peak_Pa");
    CHECK(plan.table.series.empty());
    for (std::size_t i = 0; i < 16; ++i) {
        CHECK(plan.cases[i].sample == i);
        CHECK(plan.cases[16 + i].sample == i);
        CHECK(plan.cases[i].settings[1] == plan.cases[16 + i].settings[1]);
        const double c_s = std::get<double>(plan.cases[i].settings[1].value);
        CHECK((c_s >= 4.0 && c_s <= 6.0));
        CHECK(plan.cases[i].id == case_id(plan.cases[i].physics));
    }
}

TEST_CASE("the design of Sobol indices has keys + 2 cases per sample", "[config][uncertain]") {
    const Plan plan = plan_of(two_keys, {{"uncertain.analysis", "sobol-indices"}});
    CHECK(plan.cases.size() == 64);
    CHECK(ids(plan).size() == 64);
    CHECK(plan_of(two_keys, {{"uncertain.analysis", "morris"}}).cases.size() == 48);
    // In the order in which `reduce` takes their values; 5 m/s and 1 Pa s are medians.
    const auto points = sampling::design_points(sampling::design_of(*plan.uncertain));
    for (std::size_t r = 0; r < 64; ++r)
        for (std::size_t k = 0; k < 2; ++k)
            CHECK((std::get<double>(plan.cases[r].settings[k].value) < (k == 0 ? 5.0 : 1.0)) ==
                  (points[r][k] < 0.5));
}

TEST_CASE("every sample has its own reference", "[config][uncertain]") {
    const Plan plan = plan_of(std::string(two_keys) + "[table]\nreference = { kind = \"STM\" }\n");
    REQUIRE(plan.cases.size() == 32);
    for (std::size_t i = 0; i < 16; ++i) {
        CHECK(plan.cases[i].reference_id == plan.cases[16 + i].id);
        CHECK(plan.cases[16 + i].is_reference);
        CHECK_FALSE(plan.cases[16 + i].sample);
    }
}

TEST_CASE("published distributions are offered for the keys that they fit", "[config][uncertain]") {
    CHECK(of_speed("{ preset = \"forearm-skin\" }").empty());
    const Plan plan = plan_of("[uncertain]\nsamples = 2\n\"medium.layer[1].c_s_m_s\" = { "
                              "distribution = \"uniform\", min = 26.9, max = 27.1, of = "
                              "\"youngs_modulus_kPa\" }\n");
    // 27 kPa = 3 rho c_s^2 at 3 m/s.
    CHECK(std::get<double>(plan.cases[0].settings[0].value) == Approx(3.0).epsilon(0.002));
}

TEST_CASE("hostile distributions are rejected with a clear message", "[config][uncertain]") {
    const std::string key = "\"medium.layer[1].c_s_m_s\" = ", samples = "samples = 16\n";
    const std::string uniform = "{ distribution = \"uniform\", min = 4, max = 6 }";
    const auto [text, said] = GENERATE_REF(table<std::string, std::string>({
        {samples + key + "{ distribution = \"normal\", mean = 5.0, sd = -1.0 }",
         "requires an sd above 0, but it is -1"},
        {samples + key + "{ distribution = \"cauchy\" }", "distribution"},
        {samples + key + "{ preset = \"forearm-viscosity\" }",
         "is a distribution of viscosity_Pa_s, not of medium.layer[1].c_s_m_s"},
        {samples + key + "{ preset = \"elbow\" }", "finger-skin"},
        {samples + key + "5.0", "requires a distribution"},
        {"samples = 1000000000\n" + key + uniform,
         "results in 1000000000 cases; at most 10000 are supported"},
        {"samples = 2.5\n" + key + uniform, "must be a whole number"},
        {samples, "uncertain has 0 keys with a distribution"},
        {samples + "\"load.peak\" = " + uniform, "load.peak"},
        {samples + key + uniform + "\n[sweep]\n\"medium.layer[1].c_s_m_s\" = [4, 5]",
         "is also swept"},
    }));
    CHECK(any_contains(diagnostics_of(plain_and("[uncertain]\n" + text)), said));
}

TEST_CASE("values that a distribution must not have are one error", "[config][uncertain]") {
    const Texts negative = of_speed("{ distribution = \"normal\", mean = 1.0, sd = 1.0 }");
    CHECK(any_contains(negative, "must be between 0.001 and 20000, but is -"));
    CHECK(any_contains(negative, "truncate its distribution with min and max"));
    CHECK(std::ranges::count_if(negative, [](const auto& text) {
              return text.find("error:") != text.npos;
          }) < 4); // not one for each sample
}

TEST_CASE("observed samples are read from a CSV file", "[config][uncertain]") {
    for (const char* good : {"p,other\n100,1\n110,2\n130,3\n", "p;q\r\n100.5;1\r\n110;2\r\n",
                             "p,q\n100,1,\n110,2,\n"}) // spreadsheets write empty columns
        CHECK(diagnostics_with_file(observed, good).empty());
    const std::string comma = "write decimal numbers with a point";
    const auto [csv, said] = GENERATE_REF(table<std::string, std::string>({
        {"p\n100\nnan\n", "line 3"},
        {"p\n100\n100\n", "at least two different values"},
        {"p\n100\n", "p.csv has fewer than two values in the column \"p\""},
        {"", "p.csv is empty"},
        {"q\n100\n200\n", "has no column \"p\""},
        {"p\n100,5\n110,25\n", comma},
        {"p,q\n100,5,1\n110,2\n", comma},
        {"p;q\n100,5;1\n110;2\n", comma},
        {"p,q\n\"100,5\",1\n110,2\n", comma},
    }));
    const Texts found = diagnostics_with_file(observed, csv);
    CAPTURE(found);
    CHECK(any_contains(found, said));
    CHECK((said != comma || any_contains(found, "p.csv line 2: has ")));
}

TEST_CASE("a misspelt distribution is one error", "[config][uncertain]") {
    for (const char* one : {"{ distributon = \"normal\", mean = 5, sd = 1 }",
                            "{ distribution = \"nomral\", min = 1 }",
                            "{ distribution = \"samples\", file = \"a.csv\", column = \"c\" }"}) {
        INFO(one);
        const Texts said = of_speed(one);
        REQUIRE(said.size() == 1);
        CHECK(said[0].find("distribution ") != std::string::npos);
    }
}

TEST_CASE("correlations are checked", "[config][uncertain]") {
    const auto with = [](const std::string& line, const std::string& analysis = "distribution") {
        return diagnostics_of(plain_and(std::string(two_keys) + "correlation = [ " + line + " ]\n"),
                              {{"uncertain.analysis", analysis}});
    };
    const std::string pair =
        R"(keys = ["medium.layer[1].c_s_m_s", "medium.layer[1].viscosity_Pa_s"])";
    CHECK(with("{ " + pair + ", rank = 0.6 }").empty());
    CHECK(any_contains(with("{ " + pair + ", rank = 0.6 }", "morris"), "independent keys"));
    CHECK(any_contains(with("{ " + pair + ", rank = 1.5 }"), "rank"));
    CHECK(any_contains(with(R"({ keys = ["load.peak_Pa", "a"], rank = 0.5 })"),
                       "must name two different uncertain keys"));
}

} // namespace test_uncertain
