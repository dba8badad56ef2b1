// SPDX-License-Identifier: BSD-3-Clause
#include "neural/skin/skin.hpp"

#include <catch2/catch.hpp>

#include <numbers>

namespace test_contact {

using namespace shearwake;
using namespace shearwake::neural;

static PinStimulus pressed(std::vector<Vec2> at_mm, std::vector<double> indentation_mm,
                           double radius_mm) {
    PinStimulus s{.at_mm = std::move(at_mm), .radius_mm = radius_mm};
    s.indentation_mm = Lines(indentation_mm.size(), 1);
    s.indentation_mm.values = std::move(indentation_mm);
    return s;
}

TEST_CASE("load of a single pin is 2 a E s / (1 - nu^2)", "[neural]") {
    // 1 mm indentation: 2 * 0.05 / 0.84 N, up to rounding.
    CHECK(loads_N(pressed({{}}, {1.0}, 1.0)).values[0] == Approx(0.1 / 0.84).epsilon(1e-14));
    CHECK(loads_N(pressed({{3.0, 4.0}}, {-0.5}, 2.0)).values[0] ==
          Approx(-0.1 / 0.84).epsilon(1e-14));
    CHECK(loads_N(pressed({{}}, {0.0}, 1.0)).values[0] == 0.0);
}

TEST_CASE("distant pins are independent and close pins share the load", "[neural]") {
    const double alone = loads_N(pressed({{}}, {1.0}, 0.5)).values[0];
    const Lines far = loads_N(pressed({{}, {1e6, 0.0}}, {1.0, 1.0}, 0.5));
    // The indentation by the other pin is a / (pi r) * 2 = 3e-7 of the pin's own.
    CHECK(far.values[0] == Approx(alone).epsilon(1e-6));
    const Lines near = loads_N(pressed({{}, {1.0, 0.0}}, {1.0, 1.0}, 0.5));
    CHECK(near.values[0] == near.values[1]);
    // Two equal pins: P (D_pp + D_pq) = s, D_pq / D_pp = (2/pi) asin(1/2) = 1/3.
    CHECK(near.values[0] == Approx(alone * 0.75).epsilon(1e-14));
}

TEST_CASE("load is zero for a pin that loses contact because of its neighbours", "[neural]") {
    // At a hundredth of its neighbours' indentation it lies in their hollow and would have to pull.
    const Lines loads = loads_N(pressed({{-1.0, 0.0}, {}, {1.0, 0.0}}, {1.0, 0.01, 1.0}, 0.5));
    CHECK(loads.values[1] == 0.0);
    const Lines without = loads_N(pressed({{-1.0, 0.0}, {1.0, 0.0}}, {1.0, 1.0}, 0.5));
    CHECK(loads.values[0] == without.values[0]);
    CHECK(loads.values[2] == without.values[1]);
}

TEST_CASE("surface indentation is 1/(2a) at the rim and 1/(pi r) far away", "[neural]") {
    CHECK(sinking_profile(2.0, 2.0) == 0.25);
    // Square-root behaviour at the rim.
    CHECK(sinking_profile(2.0 + 1e-12, 2.0) == Approx(0.25).epsilon(1e-5));
    CHECK(sinking_profile(500.0, 2.0) ==
          Approx(1.0 / (std::numbers::pi * 500.0)).epsilon(3e-6)); // (a/r)^2 / 6 is neglected
}

TEST_CASE("load rate is the slope of the load with copied end values", "[neural]") {
    Lines loads(1, 6);
    for (std::size_t k = 0; k < 6; ++k)
        loads.values[k] = static_cast<double>(k * k);
    // Central differences of a parabola are exact: 2 k per sample.
    CHECK(load_rates_N_s(loads, 10.0).values == std::vector{20.0, 20.0, 40.0, 60.0, 80.0, 80.0});
    CHECK(load_rates_N_s(Lines(2, 1), 10.0) == Lines(2, 1));
}

TEST_CASE("limits the pin radius to half of the smallest distance", "[neural]") {
    const std::vector<Vec2> at_mm = {{}, {0.0, 1.5}, {5.0, 0.0}};
    CHECK(fitting_radius_mm(at_mm, 1.0) == 0.75);
    CHECK(fitting_radius_mm(at_mm, 0.5) == 0.5);
    CHECK(fitting_radius_mm({{}}, 9.0) == 9.0);
}

} // namespace test_contact
