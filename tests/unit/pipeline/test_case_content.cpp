// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/case_content.hpp"

#include "pipeline/afferent_result.hpp"
#include "support/cases.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

namespace test_case_content {

using namespace shearwake;

static const Variable& find(const VariableGroup& group, const std::string& name) {
    const auto found = std::find_if(group.variables.begin(), group.variables.end(),
                                    [&](const Variable& v) { return v.name == name; });
    REQUIRE(found != group.variables.end());
    return *found;
}

TEST_CASE("the receptors of a case are placed once", "[content]") {
    Case c = test::moving_focus(test::half_space(test::tissue()), ConstantSpeed{7.0});
    CHECK_FALSE(pipeline::receptors_of(c));
    c.afferents = AfferentOptions{.places = GridAfferents{{20e-3, 20e-3}, 4e-3}};
    const auto first = pipeline::receptors_of(c);
    REQUIRE(first);
    Case other = c;
    other.scene.load.peak_Pa *= 2.0;
    CHECK(pipeline::receptors_of(other) == first);
    other.afferents->seed += 1;
    CHECK(pipeline::receptors_of(other) != first);
    CHECK(pipeline::receptors_of(other)->afferents.size() == first->afferents.size());
}

TEST_CASE("a mean map comes with the shape that was drawn, a line for each focus", "[content]") {
    Case c = test::moving_focus(test::half_space(test::tissue()), ConstantSpeed{7.0});
    c.domain = {8, 6, 0.01, 0.0};
    c.scene.load.modulation.trajectory = {{Travel{{{0.0, 0.0}, {0.025, 0.0}}, ConstantSpeed{7.0}}}};
    c.scene.load.modulation.foci_m = {{0.0, -0.01}, {0.0, 0.01}};
    const std::vector<measures::DepthSeries> depths = {
        {0.0, std::vector<measures::SurfaceSums>(224)}};
    CHECK(pipeline::field_content(c, depths, {}, std::nullopt, {}).size() == 1); // no map, no group

    const std::vector<double> mean_u2(48, 1e-12);
    const VariableGroup mean = pipeline::field_content(c, depths, {}, std::nullopt, mean_u2).back();
    CHECK(mean.name == "mean");
    CHECK(find(mean, "u_z_squared").values == mean_u2);
    // 25 mm in steps of a spacing of 10 mm at most: three.
    CHECK(find(mean, "drawn_line").values == std::vector<double>{0, 0, 0, 0, 1, 1, 1, 1});
    CHECK(find(mean, "drawn_x").values.back() == Approx(0.025).epsilon(1e-15));
    CHECK(find(mean, "drawn_y").values.front() == -0.01);
    CHECK(find(mean, "drawn_y").values.back() == 0.01);
    for (const char* name : {"drawn_line", "drawn_x", "drawn_y"})
        CHECK(find(mean, name).dimensions == std::vector<std::string>{"point"});
}

} // namespace test_case_content
