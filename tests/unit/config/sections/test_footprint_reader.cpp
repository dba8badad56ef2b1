// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/array_field.hpp"
#include "unit/config/jobs.hpp"

#include <cmath>
#include <complex>
#include <numbers>

namespace test_footprint_reader {

using namespace shearwake;
using namespace shearwake::test;

/// The plain job with another footprint, on a domain that such a focus fits on.
static std::string with_footprint(std::string_view footprint, std::string_view peak = "") {
    std::string job = plain_with("footprint = { shape = \"gaussian\", fwhm_mm = 3.0 }",
                                 "footprint = { " + std::string(footprint) + " }");
    return replaced(job, "peak_Pa = 100.0\n", peak);
}

static Load load_of(std::string_view footprint, std::string_view peak = "") {
    return only_case(with_footprint(footprint, peak)).scene.load;
}

const std::string board = "shape = \"array\", preset = \"array-16x16\", distance_mm = 200";

TEST_CASE("an array is given by its numbers or by a preset", "[config][footprint]") {
    const Load given = load_of("shape = \"array\", elements = [16, 16], pitch_mm = 10.47, "
                               "radius_mm = 4.5, distance_mm = 200, pressure_Pa_m = 3.4");
    const Load preset = load_of(board + ", pressure_Pa_m = 3.4");
    CHECK(given == preset);
    const auto& array = std::get<ArrayFootprint>(given.footprint);
    CHECK(array.columns == 16);
    CHECK(array.pitch_m == Approx(10.47e-3).epsilon(1e-15));
    CHECK(given.peak_Pa == Approx(92.0).margin(0.5)); // known to be 92 Pa
    CHECK(array.reach_m == Approx(4.0 * fwhm_m(given.footprint)).epsilon(1e-12));
}

TEST_CASE("the array of 249 elements has three empty positions", "[config][footprint]") {
    const Load load =
        load_of("shape = \"array\", preset = \"array-249\", distance_mm = 200", "peak_Pa = 50\n");
    const auto& array = std::get<ArrayFootprint>(load.footprint);
    CHECK(array.columns * array.rows - std::ssize(array.missing) == 249);
    const Load given =
        load_of("shape = \"array\", elements = [18, 14], pitch_mm = 10.16, radius_mm = 4.5, "
                "distance_mm = 200, missing = [[17, 2], [2, 2], [3, 2]]",
                "peak_Pa = 50\n");
    CHECK(given == load);
}

TEST_CASE("phases, updates, place and reach of an array are read", "[config][footprint]") {
    const auto array = std::get<ArrayFootprint>(
        load_of(board + ", phase_levels = 256, update_rate_kHz = 16, center_mm = [3, -2], reach_mm "
                        "= 30, frequency_kHz = 40.5",
                "peak_Pa = 80\n")
            .footprint);
    CHECK(array.phase_levels == 256);
    CHECK(array.update_rate_Hz == 16e3);
    CHECK(array.center_m == Vec2{0.003, -0.002});
    CHECK(array.reach_m == 0.03);
    CHECK(array.frequency_Hz == 40.5e3);
}

TEST_CASE("numbers of an array can be swept", "[config][footprint][slow]") {
    const std::string job = with_footprint(board + ", pressure_Pa_m = 3.4") +
                            "[sweep]\n\"load.footprint.pressure_Pa_m\" = [2.53, 3.4]\n"
                            "\"load.footprint.distance_mm\" = [150, 200]\n";
    const config::Job read = config::read_job(job, "job.toml");
    REQUIRE(read.plan.cases.size() == 4);
    CHECK(read.plan.cases[1].physics.scene.load.peak_Pa == Approx(51.0).margin(0.5));
}

TEST_CASE("the strength of a piston is not limited like a length", "[config][footprint]") {
    CHECK(load_of(board + ", pressure_Pa_m = 12").peak_Pa ==
          Approx(9.0 * load_of(board + ", pressure_Pa_m = 4").peak_Pa));
}

TEST_CASE("an error in an array is reported with its location", "[config][footprint]") {
    const auto [footprint, peak, said] = GENERATE_REF(table<std::string, std::string, std::string>({
        {board, "",
         "load.peak_Pa is missing (or load.footprint.pressure_Pa_m, the strength of the array's "
         "pistons)"},
        {board + ", pressure_Pa_m = 3", "peak_Pa = 5\n",
         "load.peak_Pa and load.footprint.pressure_Pa_m are both given; remove one of them from "
         "the job"},
        {board + ", pitch = 9", "peak_Pa = 5\n",
         "load.footprint.pitch is unknown; the unit of pitch is mm: use pitch_mm"},
        {board + ", elements = [16]", "peak_Pa = 5\n",
         "load.footprint.elements must be two whole numbers, the number of elements along x and "
         "along y"},
        {board + ", missing = [[0, 1]]", "peak_Pa = 5\n",
         "load.footprint.missing must contain positions [column, row] from [1, 1] to [16, 16], but "
         "contains [0, 1]"},
    }));
    check_only(diagnostics_of(with_footprint(footprint, peak)), "error: " + said);
}

TEST_CASE("several foci are positions relative to the moving point", "[config][footprint]") {
    const auto job = [](std::string_view foci) {
        return plain_with("kind = \"AM-STM\"\n",
                          "kind = \"AM-STM\"\nfoci_mm = " + std::string(foci) + "\n");
    };
    CHECK(only_case(job("[[-5, 0], [5, 0]]")).scene.load.modulation.foci_m ==
          std::vector<Vec2>{{-0.005, 0.0}, {0.005, 0.0}});
    CHECK(diagnostics_of(job("[]")) ==
          Texts{"job.toml:18:11: error: load.modulation.foci_mm must contain at least one focus"});
    CHECK(diagnostics_of(job("[[1, 0], [1, 0]]")) ==
          Texts{"job.toml:18:11: error: load.modulation.foci_mm has foci 1 and 2 at the same "
                "position"});
}

/// Radiation pressure of the 249 elements, each of 1 Pa m, focused below their middle, summed
/// element by element, from the numbers of the preset as the manual prints them [Pa].
static double pressure_of_249_Pa(double x_m, double y_m) {
    const double pitch_m = 10.16e-3, radius_m = 4.5e-3, distance_m = 0.2, c_m_s = 346.1;
    const double k = 2.0 * std::numbers::pi * 40e3 / c_m_s;
    std::complex<double> p = 0.0;
    for (int row = 1; row <= 14; ++row)
        for (int column = 1; column <= 18; ++column) {
            if (row == 2 && (column == 2 || column == 3 || column == 17)) continue;
            const double px = (column - 9.5) * pitch_m, py = (row - 7.5) * pitch_m;
            const double to_focus = std::hypot(px, py, distance_m);
            const double aside = std::hypot(x_m - px, y_m - py), r = std::hypot(aside, distance_m);
            const double s = k * radius_m * aside / r; // never 0: no element is below the middle
            p += std::polar(2.0 * std::cyl_bessel_j(1.0, s) / s / r, k * (r - to_focus));
        }
    return std::norm(p) / (1.184 * c_m_s * c_m_s);
}

/// Distance along a direction at which half of the pressure is left [m].
static double half_of_249_m(double along_x, double along_y) {
    double low = 0.0, high = 8e-3; // before the first zero
    for (int i = 0; i < 50; ++i) {
        const double middle = 0.5 * (low + high);
        const bool above = pressure_of_249_Pa(middle * along_x, middle * along_y) >
                           0.5 * pressure_of_249_Pa(0.0, 0.0);
        (above ? low : high) = middle;
    }
    return low;
}

TEST_CASE("the pressure of the array of 249 elements is the sum over its elements",
          "[config][footprint]") {
    const double strength_Pa_m = GENERATE(2.53, 3.4);
    const Load load =
        load_of("shape = \"array\", preset = \"array-249\", distance_mm = 200, pressure_Pa_m = " +
                std::to_string(strength_Pa_m));
    // 249 roundings of phases of 150 rad, some 1e-12.
    CHECK(load.peak_Pa ==
          Approx(strength_Pa_m * strength_Pa_m * pressure_of_249_Pa(0.0, 0.0)).epsilon(1e-10));
    const double width_x_m = half_of_249_m(1.0, 0.0) + half_of_249_m(-1.0, 0.0);
    const double width_y_m = half_of_249_m(0.0, 1.0) + half_of_249_m(0.0, -1.0);
    // The program doubles the half towards larger x and y; the three empty places make the two
    // halves differ by 8e-4 along y, 3e-4 along x.
    CHECK(fwhm_m(load.footprint) == Approx(std::sqrt(width_x_m * width_y_m)).epsilon(6e-4));
}

} // namespace test_footprint_reader
