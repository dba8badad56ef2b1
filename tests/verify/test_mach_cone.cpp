// SPDX-License-Identifier: BSD-3-Clause
#include "support/cases.hpp"

#include <catch2/catch.hpp>

namespace test_mach_cone {

using namespace shearwake;

TEST_CASE("wake of a fast focus has the Mach angle of the Rayleigh wave", "[verify]") {
    // Lossless; sin theta = c_R / v with the Rayleigh speed c_R of the same medium.
    const double speed = GENERATE(7.0, 8.0, 10.0);
    Case c = test::moving_focus(test::half_space(test::tissue(1500.0, 0.0)), ConstantSpeed{speed});
    auto& travel = test::travel_of(c);
    std::get<Line>(travel.path.shape).from_m = {-70e-3, 0.0};
    c.domain = {320, 216, 0.75e-3, 0.0};
    c.time = {280, 50e-6};
    LayeredOptions options;
    c.solver = options;
    const auto engine = engines::make_engine(c.solver);
    const Comm alone = Comm::world().split(Comm::world().rank());
    const auto columns = test::columns_of(c, *engine, alone);
    const double theory =
        std::asin(rayleigh_speed_m_s(c.scene.medium.layers[0]) / speed) * 180.0 / M_PI;
    CHECK(columns.at("mach_angle_theory_deg") == Approx(theory).epsilon(1e-12));
    CHECK(std::abs(columns.at("mach_angle_deg") - theory) < 1.0); // required
}

} // namespace test_mach_cone
