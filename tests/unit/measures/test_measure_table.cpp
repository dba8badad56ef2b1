// SPDX-License-Identifier: BSD-3-Clause
#include "measures/measure_table.hpp"

#include <catch2/catch.hpp>
#include <set>

namespace test_measure_table {

using namespace shearwake;
using namespace shearwake::measures;

TEST_CASE("every column has one entry of its own, with unit and words", "[measures]") {
    std::set<std::string> names;
    for (const Measure& measure : all_measures()) {
        INFO(measure.name);
        CHECK(names.insert(measure.name).second);
        CHECK_FALSE(std::string(measure.unit).empty());
        CHECK_FALSE(with_details(measure.meaning, {}).empty());
        CHECK(find_measure(measure.name) == &measure);
        if (*measure.over_reference_of) CHECK(find_measure(measure.over_reference_of));
    }
}

TEST_CASE("a column finds its entry whatever its details are", "[measures]") {
    const auto [column, entry] = GENERATE(table<const char*, const char*>(
        {{"focal_rms_um", "focal_rms_um"},
         {"focal_rms_um_z1.5mm", "focal_rms_um"},
         {"eta_period_1_z0.3mm", "eta_period_1"},
         {"share_100_500_1", "share_{low}_{high}_1"},
         {"velocity_share_0.5_500_1", "velocity_share_{low}_{high}_1"},
         {"PC_vector_strength_1", "{class}_vector_strength_1"}}));
    INFO(column);
    REQUIRE(find_measure(column));
    CHECK(std::string(find_measure(column)->name) == entry);
    CHECK_FALSE(find_measure("wall_s"));
    CHECK_FALSE(find_measure("focal_rms_um_z"));
}

TEST_CASE("text in brackets is omitted without its details", "[measures]") {
    const Detail radius{"radius", "3"};
    CHECK(with_details("disc[ of radius {radius} mm], now", std::span(&radius, 1)) ==
          "disc of radius 3 mm, now");
    CHECK(with_details("disc[ of radius {radius} mm], now", {}) == "disc, now");
    CHECK(with_details("{class} afferents", {}) == "{class} afferents");
}

TEST_CASE("parts of sums add, and the larger peaks are kept", "[measures]") {
    const SurfaceSums a{1, 2, 3, 4, 5, 6, 7}, b{10, 20, 30, 40, 50, 60, 6};
    CHECK(combine(a, b) == SurfaceSums{11, 22, 33, 44, 55, 66, 7});
}

} // namespace test_measure_table
