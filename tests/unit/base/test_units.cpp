// SPDX-License-Identifier: BSD-3-Clause
#include "base/units.hpp"

#include <catch2/catch.hpp>

namespace test_units {

using namespace shearwake;

TEST_CASE("finds the longest unit at the end of a key", "[units]") {
    CHECK(unit_of("speed_m_s")->quantity == "speed");
    CHECK(unit_of("viscosity_Pa_s")->quantity == "viscosity");
    CHECK(unit_of("density_kg_m3")->to_SI == 1.0);
    CHECK(unit_of("peak_Pa")->quantity == "pressure");
    CHECK(unit_of("at_ms")->to_SI == 1e-3);
    CHECK(unit_of("tau_us")->to_SI == 1e-6);
    CHECK(unit_of("carrier_kHz")->to_SI == 1e3);
    CHECK(unit_of("absorption_dB_m")->quantity == "absorption");
    CHECK(unit_of("pressure_Pa_m")->quantity == "strength");
}

TEST_CASE("finds no unit in a key without one", "[units]") {
    const std::string key =
        GENERATE("mach", "c_p_over_c_s", "focal_radius_fwhm", "am_depth", "_mm", "", "kind");
    CHECK_FALSE(unit_of(key));
    CHECK(without_unit(key) == key);
}

TEST_CASE("removes the unit from the end of a key", "[units]") {
    CHECK(without_unit("thickness_mm") == "thickness");
    CHECK(without_unit("c_s_m_s") == "c_s");
}

} // namespace test_units
