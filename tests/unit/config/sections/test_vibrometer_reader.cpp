// SPDX-License-Identifier: BSD-3-Clause
#include "unit/config/jobs.hpp"

namespace test_vibrometer_reader {

using namespace shearwake;
using namespace shearwake::test;

static VibrometerOptions read(const std::string& keys) {
    return only_case(plain_and("[vibrometer]\n" + keys + "\n")).vibrometer.value();
}

TEST_CASE("the points of a scan follow from its shape", "[config][vibrometer]") {
    const auto line = read("line_mm = [[-10, 0], [10, 0]]\nspacing_mm = 5").points_m;
    REQUIRE(line.size() == 5);
    for (std::size_t n = 0; n < line.size(); ++n) {
        CHECK(line[n].x == Approx(5e-3 * static_cast<double>(n) - 0.01).margin(1e-15)); // rounding
        CHECK(line[n].y == 0.0);
    }
    CHECK(read("grid_mm = [10, 4]\nspacing_mm = 2\ncenter_mm = [1, 0]").points_m.size() == 18);
    CHECK(read("points_mm = [[1, 2]]").points_m == std::vector<Vec2>{{0.001, 0.002}});
    for (const Vec2 point :
         read("polygon_mm = [[0, 0], [10, 0], [0, 10]]\nspacing_mm = 1").points_m)
        CHECK(point.x + point.y <= 0.01 + 1e-12);
}

TEST_CASE("the numbers of a vibrometer are read in their units", "[config][vibrometer]") {
    const VibrometerOptions options =
        read("points_mm = [[0, 0]]\ntilt_deg = 30\nnoise_um_s_rtHz = 2\nmissing_percent = 10\n"
             "sampling_rate_kHz = 12\nhigh_pass_Hz = 20\nspot_um = 80");
    CHECK(options.line_of_sight().x == Approx(0.5));
    CHECK(options.noise_m_s_rtHz == Approx(2e-6));
    CHECK(options.missing_share == Approx(0.1));
    CHECK(options.rate_Hz == 12e3);
    CHECK(options.spot_m == Approx(80e-6));
}

TEST_CASE("an error in a vibrometer is reported", "[config][vibrometer]") {
    const auto [keys, said] = GENERATE(table<std::string, std::string>({
        {"spacing_mm = 1", "vibrometer.points_mm or one of grid_mm, polygon_mm, line_mm and file "
                           "is required, and only one of them"},
        {"grid_mm = [4, 4]", "vibrometer.spacing_mm is missing"},
        {"grid_mm = [90, 60]\nspacing_mm = 0.01", "vibrometer.spacing_mm results in "},
        {"line_mm = [[0, 0]]\nspacing_mm = 1", "vibrometer.line_mm must contain two different"},
        {"points_mm = [[90, 0]]", "vibrometer.points_mm has a point at [90, 0] mm outside"},
        {"points_mm = [[0, 0]]\nlow_pass_Hz = 20000", "vibrometer.low_pass_Hz must be below half"},
    }));
    CHECK(
        any_contains(diagnostics_of(plain_and("[vibrometer]\n" + keys + "\n")), "error: " + said));
}

} // namespace test_vibrometer_reader
