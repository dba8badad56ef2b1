// SPDX-License-Identifier: BSD-3-Clause
#include "engines/registry/check.hpp"
#include "unit/engines/registry/remarks.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

namespace test_check {

using namespace shearwake;

/// A case without a remark: a path of 28 mm at 7 m/s through 96 x 67.5 mm in 4 ms.
static Case good_case() {
    Case c;
    c.scene.medium.layers = {Layer{.name = "tissue",
                                   .thickness_m = 0.02,
                                   .density_kg_m3 = 1000.0,
                                   .c_p_m_s = 1500.0,
                                   .c_s_m_s = 5.0,
                                   .loss = KelvinVoigt{1.0}}};
    c.scene.load.peak_Pa = 100.0;
    c.scene.load.footprint = GaussianFootprint{0.003};
    c.scene.load.modulation = {"AM-STM",
                               {{Travel{{{-0.014, 0.0}, {0.014, 0.0}}, ConstantSpeed{7.0}}}},
                               {{SineGain{500.0}}}};
    c.domain = {.nx = 128, .ny = 90, .spacing_m = 0.00075};
    c.time = {.frames = 80, .interval_s = 5e-5};
    c.measure = {.at_s = 0.004, .settled_after_s = 0.0012, .focal_radius_m = 0.003};
    c.record.traces_m = {{}};
    return c;
}

static Travel& travel(Case& c) {
    return std::get<Travel>(c.scene.load.modulation.trajectory.parts[0]);
}

static void warns(const Case& c, std::string_view key, const auto&... texts) {
    test::check_remark(check(c), Severity::warning, key, {texts...});
}

static void rejects(const Case& c, std::string_view key, const auto&... texts) {
    test::check_remark(check(c), Severity::error, key, {texts...});
}

/// Whether one of several remarks is an error with this text.
static bool has_error(const Case& c, std::string_view text) {
    return std::ranges::any_of(check(c), [&](const Remark& remark) {
        return remark.severity == Severity::error && remark.message.find(text) != std::string::npos;
    });
}

TEST_CASE("a valid case has no remarks", "[check]") {
    CHECK(check(good_case()).empty());
}

TEST_CASE("a coarse grid gives a warning, and one that does not resolve the focus an error",
          "[check]") {
    Case c = good_case();
    c.domain = {.nx = 80, .ny = 60, .spacing_m = 0.0012};
    warns(c, "domain.spacing_mm", "spacing is 1.2 mm, which gives 2.5 points per width");
    c.domain = {.nx = 48, .ny = 36, .spacing_m = 0.0021};
    rejects(c, "", "at most 1 mm");
}

TEST_CASE("frames that do not resolve the load give a warning", "[check]") {
    Case c = good_case();
    c.time = {.frames = 20, .interval_s = 2e-4};
    warns(c, "time.output_interval_us", "frames every 200 us represent it only up to 2500 Hz");
}

TEST_CASE("a modulation with fewer than four frames per period gives a warning", "[check]") {
    Case c = good_case();
    travel(c).motion = ConstantSpeed{0.5}; // so slow that only the envelope matters
    c.scene.load.modulation.envelope.gains = {SineGain{6000.0}};
    warns(c, "time.output_interval_us", "the modulation of 6000 Hz");
}

TEST_CASE("a pressure that strains the tissue or that is a sound pressure gives a warning",
          "[check]") {
    Case c = good_case(); // mu = 25 kPa
    c.scene.load.peak_Pa = 3000.0;
    CHECK(check(c).empty());       // 1.9 %
    c.scene.load.peak_Pa = 4500.0; // as p^2/(rho c^2), 143 Pa
    warns(c, "", "p^2/(rho c^2) = 143 Pa");
    c.scene.load.peak_Pa = 0.1; // kPa
    warns(c, "", "0.1 Pa is far below those of devices in air");
    c.scene.load.peak_Pa = 9000.0;
    warns(c, "load.peak_Pa");
    // .155 9000/25000, and 9000^2/(1.204 343.2^2).
    warns(c, "", "strains the tissue by about 5.6 %, but the model is linear",
          "p^2/(rho c^2) = 571 Pa");
    c.scene.medium.layers[0].c_s_m_s = 20.0; // a stiff gel: .35 %
    c.domain = {.nx = 512, .ny = 512, .spacing_m = 0.00075};
    warns(c, "", "strains the tissue by about 0.35 %; devices in air");
    // A thin stiff film does not protect the soft layer below it.
    c = good_case();
    c.scene.load.peak_Pa = 2000.0;
    c.scene.medium.layers[0].c_s_m_s = 1.9;
    Layer film = c.scene.medium.layers[0];
    film.thickness_m = 2e-5;
    film.c_s_m_s = 30.0;
    c.scene.medium.layers.insert(c.scene.medium.layers.begin(), film);
    warns(c, "", "strains the tissue by about 8.6 %");
}

TEST_CASE("lengths in m and times in s instead of mm and ms give a warning", "[check]") {
    Case c = good_case();
    c.measure.settled_after_s = 1.2e-6;
    warns(c, "measure.settled_after_ms");
    c = good_case();
    c.scene.load.modulation.envelope.gains.push_back(RampGain{.duration_s = 2e-6});
    const auto of_ramp = check(c); // the kink also has frequencies that alias
    CHECK(std::ranges::count(of_ramp, "load.modulation.ramp_ms", &Remark::key) == 1);
    c = good_case();
    c.scene.medium.layers[0].density_kg_m3 = 1.05;
    c.scene.load.peak_Pa = 1.0;
    warns(c, "medium.layer", "density of 1.05 kg/m^3");
    c = good_case();
    c.scene.medium.layers[0].thickness_m = 1.2e-5;
    warns(c, "", "0.012 mm thick in total");
    c = good_case();
    c.scene.load.modulation.trajectory = {{Travel{Arc{.radius_m = 2.5e-5, .sweep_rad = 6.283185},
                                                  ConstantSpeed{0.1}, AtEnd::repeat}}};
    warns(c, "load.modulation.path", "the size of the path is 0.05 mm");
}

TEST_CASE("properties of layers in other units than those of the keys give a warning", "[check]") {
    Case c = good_case();
    Layer& layer = c.scene.medium.layers[0];
    layer.density_kg_m3 = 8000.0;
    warns(c, "", "density of 8e+03 kg/m^3");
    layer.density_kg_m3 = 1000.0;
    layer.loss = KelvinVoigt{1000.0}; // mPa s: 25 kPa/(2 pi 1000 Pa s) = 4 Hz
    warns(c, "", "exceeds the shear modulus above 4 Hz");
    layer.loss = KelvinVoigt{1.0};
    layer.c_s_m_s = 500.0; // mm/s, 250 MPa
    c.domain.edges = DomainEdges::open;
    warns(c, "", "at least 2.5e+08 Pa, that of cartilage or bone");
    layer.c_s_m_s = 5.0;
    layer.thickness_m = 8.0; // um
    warns(c, "", "layer 1 is 8000 mm thick");
    layer.thickness_m = 8e-3;
    layer.c_p_m_s = 6.0; // km/s
    warns(c, "", "layer 1 has c_p = 6 m/s and c_s = 5 m/s");
}

TEST_CASE("coordinates, speeds, durations and intervals in other units give a warning", "[check]") {
    Case c = good_case(); // spacing of .75 mm
    c.record.traces_m = {{1e-5, 0.0}};
    warns(c, "record.traces_mm", "[0.01, 0] mm is closer to the centre than 5 %");
    c.record.traces_m = {{1e-16, 0.0}}; // rounding
    CHECK(check(c).empty());
    c.scene.load.modulation.foci_m = {{-2e-5, 0.0}, {2e-5, 0.0}};
    warns(c, "load.modulation.foci_mm");
    c = good_case();
    c.scene.load.modulation.trajectory = {{Hold{{0.0, 3e-5}}}};
    warns(c, "load.modulation.position_mm");
    c = good_case();
    travel(c).motion = ConstantSpeed{0.007}; // 28 mm in 4 s
    warns(c, "", "a pass along the path lasts 4000 ms, but the run 4 ms");
    c = good_case();
    std::get<Line>(travel(c).path.shape) = {{-0.0001, 0.0}, {0.0001, 0.0}}; // 200 mm in m
    travel(c).at_end = AtEnd::repeat;
    warns(c, "", "the size of the path is 0.2 mm");
    c = good_case();
    c.time = {.frames = 2, .interval_s = 1e-5}; // waves travel .1 mm
    c.measure = {.at_s = 2e-5, .focal_radius_m = 0.003};
    c.scene.load.modulation = {"AM", {{Hold{}}}, {}};
    warns(c, "time.duration_ms");
    c = good_case();
    c.time = {.frames = 80000, .interval_s = 5e-8};
    warns(c, "time.output_interval_us");
}

TEST_CASE("pins along the path of a moving focus give a warning", "[check]") {
    Case c = good_case();
    c.afferents = AfferentOptions{};
    c.afferents->pins_m = {{-0.006, 0.0}, {0.0, 0.0}, {0.006, 0.0}};
    warns(c, "afferents.input", "some of 3 pins are at times", "use afferents.input = \"stress\"");
    c.afferents->pins_m = {{0.0, 0.0}};
    CHECK(check(c).empty());
    c.afferents->pins_m = {{-0.001, 0.0}, {0.001, 0.0}};
    c.scene.load.modulation.trajectory = {{Hold{{0.0, 0.0}}}};
    CHECK(check(c).empty());
    c.afferents->pins_m = {{0.0, 0.0}, {0.0016, 0.0}}; // the FWHM is 3 mm
    warns(c, "", "1.6 mm away from the focus, which is 3 mm wide");
    c.scene.load.modulation.foci_m = {{0.0, 0.0}, {0.0016, 0.0}};
    CHECK(check(c).empty());
    c = good_case();
    c.afferents = AfferentOptions{};
    c.afferents->input = StressInput{};
    CHECK(check(c).empty());
}

TEST_CASE("a tactile pointer that draws as fast as STM gives a warning", "[check]") {
    Case c = good_case(); // 28 mm at 7 m/s: 250 passes per second
    CHECK(check(c).empty());
    c.scene.load.modulation.kind = "DTP";
    warns(c, "load.modulation.kind",
          "250 shapes per second, but a pointer moves slowly, with at most 10 shapes per "
          "second: this load is identical to that of AM-STM");
    c.scene.load.modulation.kind = "STP";
    warns(c, "", "the pointer of STP draws 250 shapes per second");
    travel(c).motion = ConstantSpeed{0.27}; // 9.6 per second
    CHECK(check(c).empty());
    c.scene.load.modulation.kind = "DTP";
    CHECK(check(c).empty());
}

TEST_CASE("a focus that leaves the domain within the run gives an error", "[check]") {
    Case c = good_case();
    std::get<Line>(travel(c).path.shape).to_m = {0.5, 0.0};
    travel(c).motion = ConstantSpeed{16.0};
    CHECK(has_error(c, "at 4 ms it is at [50, 0] mm, but the domain ends at 48 and 33.75"));
    travel(c).motion = ConstantSpeed{7.0}; // leaves long after the run
    CHECK(check(c).empty());
    c = good_case();
    c.scene.load.modulation.foci_m = {{0.0, 0.0}, {0.0, 0.05}};
    CHECK(has_error(c, "leaves the domain"));
}

TEST_CASE("a focus near the edge gives a warning", "[check]") {
    Case c = good_case();
    c.scene.medium.layers[0].c_s_m_s = 0.1; // nothing comes round
    c.scene.load.peak_Pa = 0.01;            // strains so soft a medium by 2e-4
    c.measure.settled_after_s = 0.002; // waves travel .2 mm, more than a twentieth of the focus
    travel(c).path = {{-0.014, 0.0285}, {0.014, 0.0285}};
    warns(c, "domain.extent_mm", "5.25 mm from the edge", "two focus widths, 6 mm");
}

TEST_CASE("waves that return within the run give a warning with the required extent", "[check]") {
    Case c = good_case();
    c.domain.nx = 64; // 48 mm: the wave from -14 mm is at the edge after 10 mm, 2 ms
    c.solver = SpectralOptions{};
    warns(c, "domain.extent_mm",
          "waves of 5 m/s leave through one edge and return through the opposite one into the "
          "measured region at 2 ms",
          "a domain of 68 x 68 mm would prevent this"); // 2 (14 mm + 5 m/s 4 ms) = 68 mm
    CHECK(check(c)[0].message.find("domain.edges") == std::string::npos);
    Case open = c; // only the engine layered has open edges
    open.solver = LayeredOptions{};
    warns(open, "", "and so would domain.edges = \"open\"");
    open.domain.edges = DomainEdges::open;
    CHECK(check(open).empty());
    c.domain.nx = 92; // 69 mm
    c.domain.ny = 92;
    CHECK(check(c).empty());
}

TEST_CASE("a thin top layer does not determine the speed of returning waves", "[check]") {
    Case c = good_case();
    c.scene.medium.layers.insert(c.scene.medium.layers.begin(), Layer{.name = "film",
                                                                      .thickness_m = 1e-4,
                                                                      .density_kg_m3 = 1000.0,
                                                                      .c_p_m_s = 1500.0,
                                                                      .c_s_m_s = 36.0});
    CHECK(check(c).empty());
    c.scene.medium.layers[0].thickness_m = 0.002;
    warns(c, "", "waves of 36 m/s");
}

TEST_CASE("a sponge gives a warning with engines whose edges do not absorb", "[check]") {
    Case c = good_case();
    c.domain.sponge_m = 0.003;
    warns(c, "domain.sponge_mm", "3 mm");
}

TEST_CASE("a sponge that is too narrow for the waves gives a warning with the required width",
          "[check]") {
    Case c = good_case();
    c.solver = SpectralOptions{};
    c.scene.load.modulation.envelope = {};
    c.domain.sponge_m = 0.0125; // waves of 20.4 mm
    CHECK(check(c).empty());
    c.time.frames = 400; // a sponge lets nothing come round
    CHECK(check(c).empty());
    c.time.frames = 80;
    c.domain.sponge_m = 0.010;
    warns(c, "domain.sponge_mm", "returns 2.", "12.4 mm would");
}

TEST_CASE("a path that ends before the measurement gives a warning", "[check]") {
    Case c = good_case();
    std::get<Line>(travel(c).path.shape).to_m = {0.007, 0.0};
    warns(c, "measure.at_ms", "the path ends at 3 ms");
    travel(c).at_end = AtEnd::hold;
    CHECK(check(c).empty());
    travel(c) = {{{-0.014, 0.0}, {0.01375, 0.0}}, ConstantSpeed{7.0}, AtEnd::off};
    CHECK(check(c).empty()); // within one frame of it
}

TEST_CASE("a period that does not fit into the period window gives a warning", "[check]") {
    Case c = good_case();
    c.scene.load.modulation.envelope.gains = {SineGain{200.0}};
    warns(c, "measure.settled_after_ms", "lasts 5 ms and does not fit between 1.2 and 4 ms");
}

TEST_CASE("a focal disc that is too small or too large gives a warning", "[check]") {
    Case c = good_case();
    c.measure.focal_radius_m = 0.0005;
    warns(c, "", "radius of the focal disc, 0.5 mm, is below the spacing of 0.75 mm");
    c.measure.focal_radius_m = 0.02;
    warns(c, "", "radius of the focal disc, 20 mm, is more than a quarter");
}

TEST_CASE("volumes are rejected for engines that do not store them", "[check]") {
    Case c = good_case();
    c.record.volumes_s = {c.time.frame_s(0)};
    c.record.volume_fields = {VolumeField::u};
    rejects(c, "record.volumes_ms", "solver.engine = \"spectral\"");
    c.solver = SpectralOptions{};
    CHECK(check(c).empty());
    c.record.volume_fields = {VolumeField::u, VolumeField::strain, VolumeField::stress};
    CHECK(check(c).empty());
}

TEST_CASE("side lobes that cross the edge give a warning", "[check]") {
    Case c = good_case();
    // The path comes within 33.75 mm of the edges along y, and within 34 mm along x.
    c.scene.load.footprint = ArrayFootprint{.reach_m = 0.033};
    CHECK(check(c).empty());
    c.scene.load.footprint = ArrayFootprint{.reach_m = 0.04};
    warns(c, "load.footprint", "within 33.75 mm of the edge",
          "use a larger domain or reach_mm = 33");
}

TEST_CASE("pins that the focus never approaches give a warning", "[check]") {
    Case c = good_case();
    c.afferents = AfferentOptions{};
    CHECK(check(c).empty());                            // the path of the focus crosses the origin
    c.afferents->pins_m = {{0.0, 0.01}, {0.0, 0.0031}}; // the FWHM is 3 mm
    warns(c, "afferents.pins_mm", "distance between them is 3.1 mm");
    c.afferents->pins_m.push_back({0.0, 0.0029});
    warns(c, "afferents.input"); // near, but beside a moving focus
    c.afferents->pins_m = {{0.0, 0.02}};
    c.afferents->input = StressInput{}; // has no pins
    CHECK(check(c).empty());
}

} // namespace test_check
