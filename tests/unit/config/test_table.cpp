// SPDX-License-Identifier: BSD-3-Clause
#include "unit/config/jobs.hpp"

namespace test_table {

using namespace shearwake;
using namespace shearwake::test;

static Plan plan_of(std::string_view more) {
    return config::read_job(plain_and(more), "job.toml").plan;
}

const std::string two_axes = "[sweep]\n\"load.modulation.am_frequency_Hz\" = [500, 600]\n"
                             "\"load.footprint.fwhm_mm\" = [3.0, 4.0]\n";

TEST_CASE("a table has the first axis as rows and the others as curves", "[config][table]") {
    const TableOptions table = plan_of(two_axes).table;
    CHECK(table.x == "load.modulation.am_frequency_Hz");
    CHECK(table.series == Texts{"load.footprint.fwhm_mm"});
}

TEST_CASE("the axes of a table can be exchanged", "[config][table]") {
    const TableOptions table = plan_of(two_axes + "[table]\nx = \"load.footprint.fwhm_mm\"").table;
    CHECK(table.x == "load.footprint.fwhm_mm");
    CHECK(table.series == Texts{"load.modulation.am_frequency_Hz"});
}

TEST_CASE("a key that is zipped with x does not become a series", "[config][table]") {
    const std::string zip = "[sweep]\nzip = [ { load.peak_Pa = [1, 2], domain.spacing_mm = [0.5, "
                            "0.75] } ]\nload.footprint.fwhm_mm = [3, 4]\n";
    CHECK(plan_of(zip).table.series == Texts{"load.footprint.fwhm_mm"});
    const std::string twice =
        "[sweep]\nzip = [ { load.peak_Pa = [1, 1], domain.spacing_mm = [0.5, 0.75] } ]\n";
    CHECK(plan_of(twice).table.series == Texts{"domain.spacing_mm"});
}

TEST_CASE("cases with the same reference share it", "[config][table]") {
    const Plan plan = plan_of(two_axes + "[table]\nreference = { kind = \"STM\" }\n");
    REQUIRE(plan.cases.size() == 6);
    const PlannedCase &first = plan.cases[4], &second = plan.cases[5];
    CHECK(first.is_reference);
    CHECK(first.settings == std::vector<Setting>{{"load.footprint.fwhm_mm", 3.0}});
    CHECK(second.settings == std::vector<Setting>{{"load.footprint.fwhm_mm", 4.0}});
    CHECK(first.reference_id.empty());
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK_FALSE(plan.cases[i].is_reference);
        CHECK(plan.cases[i].reference_id == plan.cases[4 + i % 2].id);
    }
    const std::string alone = plain_with("kind = \"AM-STM\"", "kind = \"STM\"");
    CHECK(first.physics == only_case(replaced(alone, "am_frequency_Hz = 500.0\n", "")));
}

TEST_CASE("a reference that is a case of the sweep is not computed twice", "[config][table]") {
    const Plan plan = plan_of("[sweep]\nload.modulation.kind = [\"STM\", \"AM-STM\"]\n[table]\n"
                              "reference = { kind = \"STM\" }\n");
    REQUIRE(plan.cases.size() == 2);
    CHECK(plan.cases[0].reference_id == plan.cases[0].id);
    CHECK(plan.cases[1].reference_id == plan.cases[0].id);
}

TEST_CASE("a job without a sweep can have a reference", "[config][table]") {
    const Plan plan = plan_of("[table]\nreference = { kind = \"STM\" }\n");
    REQUIRE(plan.cases.size() == 2);
    CHECK(plan.cases[1].is_reference);
    CHECK(plan.cases[1].settings.empty());
    CHECK(plan.cases[0].reference_id == plan.cases[1].id);
}

TEST_CASE("a reference may change keys of the kind it keeps", "[config][table]") {
    const Plan plan = plan_of("[sweep]\nload.modulation.am_depth = [0.5, 1]\nload.peak_Pa = [1, "
                              "2]\n[table]\nreference = { am_depth = 0 }\n");
    REQUIRE(plan.cases.size() == 6);
    CHECK(plan.cases[4].settings == std::vector<Setting>{{"load.peak_Pa", 1.0}});
}

TEST_CASE("an error in [table] is reported with its location", "[config][table]") {
    const auto [more, diagnostic] = GENERATE(table<std::string, std::string>({
        {"x = \"load.pek_Pa\"", "30:5 table.x contains \"load.pek_Pa\", which is not swept; did "
                                "you mean \"load.peak_Pa\"?"},
        {"x = 3", "30:5 table.x must be a string, but is a number"},
        {"series = [\"load.peak_Pa\"]", "30:10 table.series contains \"load.peak_Pa\""},
        {"reference = { kind = \"STM\", foo = 1 }", "30:29 load.modulation.foo is unknown"},
        {"reference = { kind = \"SM-STM\", speed_deviation_m_s = 1 }",
         "30:13 load.modulation.sm_frequency_Hz is missing"},
        {"labels = { \"load.pek_Pa\" = [\"a\"] }",
         "30:28 table.labels.load.pek_Pa contains \"load.pek_Pa\", which is not swept; did you "
         "mean \"load.peak_Pa\"?"},
        {"labels = { \"load.peak_Pa\" = [\"a\", \"b\", \"c\"] }",
         "30:29 table.labels.load.peak_Pa has 3 labels, but the key has 2 values"},
        {"reference = {}", "30:13 table.reference must change at least one key, for example {"},
    }));
    check_only(diagnostics_of(plain_and("[sweep]\n\"load.peak_Pa\" = [1, 2]\n[table]\n" + more)),
               error_at(diagnostic));
}

TEST_CASE("a key that the reference replaces is not swept in it", "[config][table]") {
    const std::string gain = "am_frequency_Hz = 500.0\n[[load.modulation.envelope]]\nshape = "
                             "\"sine\"\nfrequency_Hz = 600\n";
    const Plan plan =
        config::read_job(plain_with("am_frequency_Hz = 500.0\n", gain) +
                             "[sweep]\n\"load.modulation.envelope[1].frequency_Hz\" = [600, "
                             "700]\n[table]\nreference = { kind = \"STM\", envelope = [] }\n",
                         "job.toml")
            .plan;
    REQUIRE(plan.cases.size() == 3);
    CHECK(plan.cases[2].is_reference);
    CHECK(plan.cases[2].settings.empty());
    CHECK(plan.cases[2].physics.scene.load.modulation.envelope == Envelope{});
    CHECK(plan.cases[0].reference_id == plan.cases[2].id);
    CHECK(plan.cases[1].reference_id == plan.cases[2].id);
}

} // namespace test_table
