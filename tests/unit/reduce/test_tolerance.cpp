// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/diff.hpp"

#include "base/error.hpp"

#include <catch2/catch.hpp>

namespace test_tolerance {

using namespace shearwake;

TEST_CASE("only the literal ipr has a tolerance above the rounding of a table", "[tolerance]") {
    CHECK(reduce::default_tolerance("eta_at_1") == reduce::Tolerance{.relative = 1e-7});
    CHECK(reduce::default_tolerance("ipr_abs_period_mm2") == reduce::default_tolerance("eta_at_1"));
    CHECK(reduce::default_tolerance("ipr_period_mm2") == reduce::Tolerance{.relative = 1e-4});
}

TEST_CASE("a file gives tolerances by column, to all others, and what is ignored", "[tolerance]") {
    const reduce::Tolerances read =
        reduce::read_tolerances("ignore = [\"mach_angle_deg\"]\n"
                                "[tolerance]\n"
                                "eta_at_1 = 1e-5\n"
                                "peak_um = { relative = 1e-3, absolute = 2 }\n"
                                "\"*\" = 1e-6\n",
                                "t.toml");
    CHECK(read.of("eta_at_1") == reduce::Tolerance{.relative = 1e-5});
    CHECK(read.of("peak_um") == reduce::Tolerance{.relative = 1e-3, .absolute = 2.0});
    CHECK(read.of("ipr_at_1") == reduce::Tolerance{.relative = 1e-6});
    CHECK(read.ignores("mach_angle_deg"));
    CHECK(read.ignores("wall_s"));
    CHECK(read.ignores("note"));
    CHECK_FALSE(read.ignores("status"));
}

TEST_CASE("the command line changes the relative tolerance of a file", "[tolerance]") {
    reduce::Tolerances tolerances;
    tolerances.named["peak_um"] = {.relative = 1e-3, .absolute = 2.0};
    reduce::add_tolerance(tolerances, "peak_um=0.5");
    reduce::add_tolerance(tolerances, "*=0");
    CHECK(tolerances.of("peak_um") == reduce::Tolerance{.relative = 0.5, .absolute = 2.0});
    CHECK(tolerances.of("eta_at_1") == reduce::Tolerance{.relative = 0.0});
    const char* wrong = GENERATE("eta", "eta=", "=1", "eta=x", "eta=-1", "eta=inf", "eta=1e-3x");
    CHECK_THROWS_WITH(reduce::add_tolerance(tolerances, wrong),
                      Catch::Contains(wrong) && Catch::Contains("COLUMN=RELATIVE"));
}

TEST_CASE("all errors in a file of tolerances are reported with their locations", "[tolerance]") {
    const char* text = "[tolerances]\n"
                       "[tolerance]\n"
                       "a = -1\n"
                       "b = \"x\"\n"
                       "c = { relativ = 1 }\n"
                       "d = { absolute = nan }\n";
    try {
        reduce::read_tolerances(text, "t.toml");
        FAIL("it was read");
    } catch (const UsageError& error) {
        CHECK(error.code() == ExitCode::usage);
        CHECK_THAT(error.what(),
                   Catch::Contains("t.toml:1:") && Catch::Contains("tolerances is unknown") &&
                       Catch::Contains("t.toml:3:") && Catch::Contains("t.toml:4:") &&
                       Catch::Contains("c.relativ is unknown") && Catch::Contains("t.toml:6:"));
    }
    CHECK_THROWS_WITH(reduce::read_tolerances("ignore = [1]\n", "t.toml"),
                      Catch::Contains("t.toml:1:") && Catch::Contains("list of columns"));
    CHECK_THROWS_WITH(reduce::read_tolerances("tolerance = 1\n", "t.toml"),
                      Catch::Contains("[tolerance]"));
    CHECK_THROWS_WITH(reduce::read_tolerances("[tolerance\n", "t.toml"),
                      Catch::Contains("not valid TOML"));
}

} // namespace test_tolerance
