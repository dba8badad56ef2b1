// SPDX-License-Identifier: BSD-3-Clause
#include "base/png.hpp"
#include "problem/load/acoustics/lens_design.hpp"
#include "unit/config/jobs.hpp"

namespace test_lens_reader {

using namespace shearwake;
using namespace shearwake::test;

const std::string plate = "shape = \"lens\", aperture_mm = 60, distance_mm = 60, iterations = 3, "
                          "material_c_m_s = 1500, material_density_kg_m3 = 1200";

static std::string with_lens(std::string_view footprint, std::string_view peak = "peak_Pa = 5\n") {
    std::string job = plain_with("footprint = { shape = \"gaussian\", fwhm_mm = 3.0 }",
                                 "footprint = { " + std::string(footprint) + " }");
    job = replaced(job,
                   "kind = \"AM-STM\"\npath = { shape = \"line\", from_mm = [-14.0, 0.0], to_mm = "
                   "[14.0, 0.0] }\nspeed_m_s = 7.0\n",
                   "kind = \"AM\"\n");
    return replaced(job, "peak_Pa = 100.0\n", peak);
}

TEST_CASE("the pressure behind a lens gives the peak on the skin", "[config][lens]") {
    const Load load =
        only_case(with_lens(plate + ", target_foci_mm = [[0, 0]], pressure_Pa = 500", ""))
            .scene.load;
    const auto& lens = std::get<LensFootprint>(load.footprint);
    REQUIRE(lens.design);
    CHECK(lens.pixel_m == Approx(0.25 * 346.1 / 40e3));
    CHECK(lens.absorption_dB_m > 1.0); // about 1.3 dB/m at 40 kHz
    CHECK(lens.absorption_dB_m < 1.6);
    CHECK(lens.reach_m == Approx(4.0 * focal_width_m(lens)));
    const double pressure_Pa = 500.0 * lens.design->gain;
    CHECK(load.peak_Pa == Approx(pressure_Pa * pressure_Pa / (1.184 * 346.1 * 346.1)));
}

TEST_CASE("a picture is a target", "[config][lens]") {
    image::GreyImage picture{3, 2, {0.0, 1.0, 0.0, 0.0, 0.0, 0.5}};
    const std::string png = image::encode_png(picture);
    const auto load_text = [&](const std::string&) { return png; };
    const std::string job = with_lens(plate + ", target_png = \"a.png\", target_width_mm = 30");
    const config::Job read = config::read_job(job, "job.toml", {}, nullptr, load_text);
    const auto& lens = std::get<LensFootprint>(read.plan.cases.at(0).physics.scene.load.footprint);
    REQUIRE(lens.image);
    CHECK(lens.image->at({0.0, 5e-3}, 0.03) == 1.0);
    CHECK(lens.image->at({10e-3, -5e-3}, 0.03) == Approx(128.0 / 255.0));
    CHECK(lens.image->at({16e-3, 5e-3}, 0.03) == 0.0);
    CHECK(image::decode_png(png.substr(0, 40)).problem != "");
    CHECK(image::decode_png("no picture").problem != "");
}

TEST_CASE("the cases of a sweep share a lens", "[config][lens]") {
    const std::string job = with_lens(plate + ", target_foci_mm = [[0, 0]]") +
                            "[sweep]\n\"load.modulation.am_frequency_Hz\" = [400, 500]\n";
    const config::Job read = config::read_job(job, "job.toml");
    const auto design = [&](std::size_t n) {
        return std::get<LensFootprint>(read.plan.cases.at(n).physics.scene.load.footprint).design;
    };
    CHECK(design(0) == design(1));
}

TEST_CASE("the absorption of a lens is not limited like a length", "[config][lens]") {
    const auto found = diagnostics_of(
        with_lens(plate + ", target_foci_mm = [[0, 0]], absorption_dB_m = 50, reach_mm = 30"));
    CAPTURE(found);
    CHECK(found.empty());
    CHECK(any_contains(
        diagnostics_of(with_lens(plate + ", target_foci_mm = [[0, 0]], absorption_dB_m = 1001")),
        "load.footprint.absorption_dB_m must be between 0 and 1000, but is 1001"));
}

TEST_CASE("an error in a lens is reported", "[config][lens]") {
    const auto [footprint, peak, said] = GENERATE_REF(table<std::string, std::string, std::string>({
        {plate, "peak_Pa = 5\n",
         "load.footprint.shape = \"lens\" requires exactly one of target_foci_mm, "
         "target_polygon_mm and target_png"},
        {plate + ", target_foci_mm = [[0, 0]]", "",
         "load.peak_Pa is missing (or load.footprint.pressure_Pa, the amplitude of the sound "
         "behind the lens)"},
        {plate + ", target_polygon_mm = [[0, 0], [1, 1]]", "peak_Pa = 5\n",
         "load.footprint.target_polygon_mm must contain 3 to 10000 points"},
        {plate + ", target_foci_mm = [[0, 0]], pixel_mm = 20", "peak_Pa = 5\n",
         "load.footprint.pixel_mm must be at most a quarter of aperture_mm"},
        {plate + ", target_foci_mm = [[0, 30]], reach_mm = 20", "peak_Pa = 5\n",
         "load.footprint.reach_mm must be at least 30, so that it contains the target"},
        {plate + ", target_png = \"a.png\", target_width_mm = 10", "peak_Pa = 5\n",
         "load.footprint.target_png names a file, but this job is read without access to files"},
    }));
    const Texts found = diagnostics_of(with_lens(footprint, peak));
    CHECK(any_contains(found, "error: " + said));
}

TEST_CASE("the pattern of a lens does not move", "[config][lens]") {
    const std::string job = plain_with("footprint = { shape = \"gaussian\", fwhm_mm = 3.0 }",
                                       "footprint = { " + plate + ", target_foci_mm = [[0, 0]] }");
    CHECK(
        any_contains(diagnostics_of(job),
                     "load.modulation.kind moves the focus, but the pattern of a lens is static"));
}

} // namespace test_lens_reader
