// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/diff.hpp"

#include "base/error.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace test_diff {

using namespace shearwake;

namespace {

const std::string header = "id,reference,load.peak_Pa,eta_1,zero_um,wall_s,status,note\n";

reduce::TextTable read(const std::string& rows) {
    return reduce::read_csv(header + rows, "t.csv");
}

const std::string base = "a,,100,0.5,0,1.0,complete,\n"
                         "b,,200,0.25,2,1.0,complete,\n"
                         "c,yes,,0.125,4,1.0,complete,\n";

} // namespace

TEST_CASE("equal tables have no difference, independent of seconds and notes", "[diff]") {
    const auto now = read("c,yes,,0.125,4,7.0,complete,x\n"
                          "b,,200.0,0.25,2,7.0,complete,y\n"
                          "a,,100,0.5,0,7.0,complete,z\n");
    const reduce::Differences found = reduce::compare(now, read(base), {});
    CHECK(found.none());
    CHECK(found.cases == 3);
    CHECK(found.not_compared == std::vector<std::string>{"wall_s", "note"});
    CHECK_THAT(reduce::words(found), Catch::Contains("3 cases, 5 columns compared: no difference"));
}

TEST_CASE("a number may differ from the reference by at most its tolerance", "[diff]") {
    reduce::Tolerances tolerances;
    reduce::add_tolerance(tolerances, "eta_1=1e-3");
    const auto with_eta = [&](const std::string& eta) {
        return reduce::compare(read("a,,100,0.5,0,1,complete,\nb,,200," + eta +
                                    ",2,1,complete,\nc,yes,,0.125,4,1,complete,\n"),
                               read(base), tolerances);
    };
    CHECK(with_eta("0.2502499").none());
    CHECK(with_eta("0.2497501").none());
    const reduce::Differences found = with_eta("0.25025001");
    REQUIRE(found.moved.size() == 1);
    CHECK(found.moved[0].column == "eta_1");
    REQUIRE(found.moved[0].cells.size() == 1);
    CHECK(found.moved[0].cells[0].case_name == "load.peak_Pa=200");
    // A difference of numbers with eight digits, of which the last is a 2.5e-4th of the change.
    CHECK(found.moved[0].cells[0].change == Approx(1e-3).epsilon(1e-4));
}

TEST_CASE("changes and tolerances in dB are those of the amplitude, also at 0 dB", "[diff]") {
    const auto found = [](const std::string& level, const std::string& tolerance) {
        const auto table = [](const std::string& value) {
            return reduce::read_csv("id,reference,load.peak_Pa,felt_path_dB,status\na,,100," +
                                        value + ",complete\n",
                                    "t.csv");
        };
        reduce::Tolerances tolerances;
        if (!tolerance.empty()) reduce::add_tolerance(tolerances, "felt_path_dB=" + tolerance);
        return reduce::compare(table(level), table("0.001"), tolerances);
    };
    // The default is 1e-7 of the amplitude, 8.7e-7 dB, not 1e-7 of 0.001 dB.
    CHECK(found("0.0010008", "").none());
    CHECK_FALSE(found("0.0010009", "").none());
    CHECK(found("0.0870", "0.01").none()); // 0.086 dB
    const auto louder = found("6.0215999", "0.01");
    REQUIRE(louder.moved.size() == 1);
    CHECK(louder.moved[0].cells[0].change == Approx(1.0).epsilon(1e-5)); // 6.0206 dB: twice
}

TEST_CASE("if the reference is 0, the largest value of the column or an absolute tolerance applies",
          "[diff]") {
    const auto with_zero = [&](const std::string& zero, const reduce::Tolerances& tolerances) {
        return reduce::compare(
            read("a,,100,0.5," + zero +
                 ",1,complete,\nb,,200,0.25,2,1,complete,\nc,yes,,0.125,4,1,complete,\n"),
            read(base), tolerances);
    };
    CHECK(with_zero("3.9e-7", {}).none()); // 1e-7 of the largest, 4
    const reduce::Differences found = with_zero("-4.1e-7", {});
    REQUIRE(found.moved.size() == 1);
    CHECK(found.moved[0].cells[0].change == Approx(-4.1e-7 / 4.0));
    reduce::Tolerances tolerances;
    tolerances.named["zero_um"] = {.relative = 0.0, .absolute = 0.1};
    CHECK(with_zero("0.09", tolerances).none());
    CHECK_FALSE(with_zero("0.11", tolerances).none());
}

TEST_CASE("a number never matches an empty cell or text", "[diff]") {
    const auto now = read("a,,100,,0,1,complete,\n"
                          "b,,200,0.25,2,1,failed,\n"
                          "c,yes,,inf,4,1,complete,\n");
    const reduce::Differences found = reduce::compare(now, read(base), {});
    REQUIRE(found.moved.size() == 2);
    CHECK(found.moved[0].column == "eta_1");
    CHECK(found.moved[0].cells.size() == 2);
    CHECK(std::isinf(found.moved[0].cells[0].over_tolerance));
    CHECK_THAT(reduce::words(found),
               Catch::Contains("became empty: 0.5 -> (empty) at load.peak_Pa=100") &&
                   Catch::Contains("2 of 3 cases changed") &&
                   Catch::Contains("complete -> failed at load.peak_Pa=200"));
}

TEST_CASE("the largest change is listed first", "[diff]") {
    const auto now = read("a,,100,0.51,0,1,complete,\n"
                          "b,,200,0.26,2,1,complete,\n"
                          "c,yes,,0.125,4.0001,1,complete,\n");
    const reduce::Differences found = reduce::compare(now, read(base), {});
    REQUIRE(found.moved.size() == 2);
    CHECK(found.moved[0].column == "eta_1");
    CHECK(found.moved[0].cells[0].case_name == "load.peak_Pa=200"); // 4 %, then 2 %
    CHECK(found.moved[0].cells[0].over_tolerance == Approx(4e5));
    CHECK(found.moved[1].column == "zero_um");
    CHECK(found.moved[1].cells[0].case_name == "the reference");
    const std::string text = reduce::words(found);
    CHECK(text.find("eta_1") < text.find("zero_um"));
    CHECK_THAT(text, Catch::Contains("+4 %, 4e+05 times its tolerance (1e-07): 0.25 -> 0.26"));
}

TEST_CASE("cases and columns that only one table has are differences", "[diff]") {
    const auto now = reduce::read_csv("id,reference,load.peak_Pa,eta_1,status,new_1\n"
                                      "a,,100,0.5,complete,1\n"
                                      "c,yes,,0.125,complete,1\n"
                                      "d,,300,0.1,complete,1\n",
                                      "now.csv");
    const reduce::Differences found = reduce::compare(now, read(base), {});
    CHECK(found.moved.empty());
    CHECK(found.missing_cases == std::vector<std::string>{"load.peak_Pa=200"});
    CHECK(found.extra_cases == std::vector<std::string>{"load.peak_Pa=300"});
    CHECK(found.missing_columns == std::vector<std::string>{"zero_um"});
    CHECK(found.extra_columns == std::vector<std::string>{"new_1"});
    CHECK_FALSE(found.none());
    CHECK_THAT(reduce::words(found), Catch::Contains("missing column: zero_um") &&
                                         Catch::Contains("extra case: load.peak_Pa=300"));
    reduce::Tolerances ignoring;
    ignoring.ignored = {"new_1", "zero_um"};
    CHECK(reduce::compare(now, read(base), ignoring).extra_columns.empty());
    CHECK(reduce::compare(now, read(base), ignoring).missing_columns.empty());
}

TEST_CASE("cases with different ids are matched by their swept values", "[diff]") {
    const auto now = read("z,yes,,0.125,4,1,complete,\n"
                          "y,,2e2,0.25,2,1,complete,\n"
                          "x,,100,0.5,0,1,complete,\n");
    const reduce::Differences found = reduce::compare(now, read(base), {});
    CHECK(found.missing_cases.empty());
    CHECK(found.extra_cases.empty());
    CHECK(found.cases_of_other_id == 3);
    CHECK(found.none()); // 2e2 is 200
    CHECK_THAT(reduce::words(found), Catch::Contains("3 cases with different ids"));
}

TEST_CASE("cases with ambiguous swept values are not matched", "[diff]") {
    const auto now = read("x,,100,0.5,0,1,complete,\n"
                          "y,,100,0.5,0,1,complete,\n"
                          "c,yes,,0.125,4,1,complete,\n");
    const reduce::Differences found = reduce::compare(now, read(base), {});
    CHECK(found.cases == 1);
    CHECK(found.missing_cases.size() == 2);
    CHECK(found.extra_cases.size() == 2);
}

TEST_CASE("a tolerance of a column that neither table has is rejected", "[diff]") {
    reduce::Tolerances tolerances;
    reduce::add_tolerance(tolerances, "eta_2=1");
    CHECK_THROWS_WITH(reduce::compare(read(base), read(base), tolerances),
                      Catch::Contains("eta_2") && Catch::Contains("did you mean eta_1?"));
}

TEST_CASE("the JSON contains every changed cell", "[diff]") {
    const auto now = read("a,,100,0.51,,1,complete,\n"
                          "b,,200,0.26,2,1,complete,\n"
                          "c,yes,,0.125,4,1,complete,\n");
    const std::string text =
        reduce::json_text(reduce::compare(now, read(base), {}), "now.csv", "base.csv");
    CHECK_THAT(text, Catch::Contains("\"equal\": false") && Catch::Contains("\"0.51\"") &&
                         Catch::Contains("\"0.26\"") &&
                         Catch::Contains("\"over_tolerance\": null"));
}

} // namespace test_diff
