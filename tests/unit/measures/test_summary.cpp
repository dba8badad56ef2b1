// SPDX-License-Identifier: BSD-3-Clause
#include "measures/summary.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>

namespace test_summary {

using namespace shearwake;

/// AM-STM at 200 Hz and 7 m/s over 14 ms, frames every 50 us.
static Case thesis_case() {
    Case c;
    c.scene.medium = {
        .layers = {
            {.thickness_m = 0.02, .density_kg_m3 = 1000.0, .c_p_m_s = 1500.0, .c_s_m_s = 5.0}}};
    c.scene.load = {.peak_Pa = 100.0, .footprint = GaussianFootprint{.fwhm_m = 3e-3}};
    c.scene.load.modulation = {.kind = "AM-STM",
                               .trajectory = {{Travel{.path = {{-49e-3, 0.0}, {49e-3, 0.0}},
                                                      .motion = ConstantSpeed{7.0}}}},
                               .envelope = {{SineGain{.frequency_Hz = 200.0}}}};
    c.domain = {.nx = 256, .ny = 192, .spacing_m = 0.75e-3, .sponge_m = 12e-3};
    c.time = {.frames = 280, .interval_s = 50e-6};
    c.measure = {.at_s = 14e-3, .settled_after_s = 4e-3, .focal_radius_m = 3e-3};
    return c;
}

constexpr double disc_cells = 16.0 * std::numbers::pi; // a radius of 3 mm in cells of 0.75 mm

/// Frame n: 100 samples of n nm, and 20 in the focal disc.
static measures::DepthSeries growing(double depth_m, std::ptrdiff_t frames, double scale = 1.0) {
    measures::DepthSeries series{.depth_m = depth_m};
    for (std::ptrdiff_t n = 0; n < frames; ++n) {
        const double u = scale * 1e-9 * static_cast<double>(n + 1), u2 = u * u;
        series.frames.push_back({.u = 100 * u,
                                 .abs_u = 100 * u,
                                 .u2 = 100 * u2,
                                 .u4 = 100 * u2 * u2,
                                 .focal_u2 = 20 * u2,
                                 .focal_weight = disc_cells,
                                 .peak = u});
    }
    return series;
}

static measures::TraceSeries tone_at(Vec2 at_m, double frequency_Hz) {
    measures::TraceSeries trace{.at_m = at_m};
    for (int n = 1; n <= 280; ++n)
        trace.u_m.push_back(1e-6 * std::sin(2 * std::numbers::pi * frequency_Hz * 50e-6 * n));
    return trace;
}

static measures::Column find(const std::vector<measures::Column>& columns,
                             const std::string& name) {
    const auto found = std::ranges::find(columns, name, &measures::Column::name);
    INFO(name);
    REQUIRE(found != columns.end());
    return *found;
}

TEST_CASE("the table has columns in this order, once, with a unit and a description", "[summary]") {
    const auto columns =
        measures::summarise(thesis_case(), {growing(0.0, 280)}, {tone_at({}, 300)}, {});
    std::set<std::string> names;
    for (const measures::Column& column : columns) {
        CHECK(names.insert(column.name).second);
        CHECK_FALSE(column.unit.empty());
        CHECK_FALSE(column.long_name.empty());
    }
    std::istringstream expected(
        "eta_at_1 eta_period_1 ipr_at_1 ipr_at_mm2 ipr_period_1 ipr_period_mm2 ipr_abs_at_1 "
        "ipr_abs_at_mm2 ipr_abs_period_1 ipr_abs_period_mm2 participation_at_1 "
        "participation_at_mm2 participation_period_1 participation_period_mm2 peak_um "
        "focal_rms_um impulse_mN_ms peak_frequency_Hz velocity_peak_frequency_Hz rms_40_400_um "
        "rms_5_300_um rms_5_800_um mach_angle_deg mach_angle_theory_deg sharpness_1 periods");
    auto at = columns.begin(); // other measures may stand between these
    for (std::string name; expected >> name; ++at) {
        INFO(name);
        at = std::ranges::find(at, columns.end(), name, &measures::Column::name);
        REQUIRE(at != columns.end());
    }
}

TEST_CASE("the table holds the measures in its units", "[summary]") {
    const Case c = thesis_case();
    const std::vector<double> even(static_cast<std::size_t>(c.domain.nx * c.domain.ny), 1e-18);
    const auto columns = measures::summarise(c, {growing(0.0, 280)}, {tone_at({}, 300)},
                                             measures::MachFit{.angle_deg = 42.5}, even);
    const auto value = [&](const std::string& name) {
        const measures::Column column = find(columns, name);
        CHECK(column.note.empty());
        return column.value;
    };
    // Ratios of products: rounding.
    CHECK(value("eta_at_1") == Approx(0.2).epsilon(1e-12));
    CHECK(value("eta_period_1") == Approx(0.2).epsilon(1e-12));
    CHECK(value("ipr_at_1") == Approx(100).epsilon(1e-12));
    CHECK(value("ipr_at_mm2") == Approx(100 * 0.5625).epsilon(1e-12));
    CHECK(value("ipr_abs_period_mm2") == Approx(100 * 0.5625).epsilon(1e-12));
    CHECK(value("participation_period_1") == Approx(100).epsilon(1e-12));
    CHECK(value("peak_um") == Approx(0.28).epsilon(1e-12));
    // rms of a straight line from 80 to 280 nm, times sqrt(20/disc_cells); the trapezoidal rule on
    // its square over 200 intervals adds 1/6 nm^2 to 35 000.
    CHECK(value("focal_rms_um") ==
          Approx(1e-3 * std::sqrt(20.0 / disc_cells * (280.0 * 280 + 280.0 * 80 + 80.0 * 80) / 3))
              .epsilon(1e-5));
    // Half the steady force, and 2.8 periods: sin(2 pi 2.8) = -0.951.
    const double force_mN = 0.1 * std::numbers::pi * 9 / (4 * std::numbers::ln2);
    CHECK(value("impulse_mN_ms") ==
          Approx(force_mN * (7.0 + 0.5 * 0.951057 / (0.4 * std::numbers::pi))).epsilon(1e-4));
    CHECK(value("peak_frequency_Hz") == Approx(300).margin(10));           // a line of 71 Hz width
    CHECK(value("rms_40_400_um") == Approx(std::sqrt(0.5)).epsilon(0.06)); // leaks out of the band
    CHECK(value("mach_angle_deg") == 42.5);
    CHECK(value("mach_angle_theory_deg") == Approx(43.0).margin(0.05)); // c_R = 0.9553 c_s
    CHECK(value("periods") == 2);
    // The same energy everywhere: a strip of 6 mm along a path, half a disc at either end, over
    // all.
    const auto& path = std::get<Travel>(c.scene.load.modulation.trajectory.parts.front()).path;
    const double strip_m2 = 6e-3 * length_m(path) + std::numbers::pi * 9e-6;
    const double measured_m2 = (192e-3 - 24e-3) * (144e-3 - 24e-3); // inside the sponge
    // The rims of the half discs count by cells: a thousandth of the strip.
    CHECK(value("sharpness_1") == Approx(strip_m2 / measured_m2).epsilon(1e-3));
}

TEST_CASE("a period that does not fit leaves empty cells with the reason", "[summary]") {
    Case c = thesis_case();
    c.scene.load.modulation.envelope = {{SineGain{.frequency_Hz = 50.0}}};
    const auto columns = measures::summarise(c, {growing(0.0, 280)}, {}, {});
    for (const char* name : {"eta_period_1", "ipr_period_mm2", "focal_rms_um", "periods"}) {
        CHECK(std::isnan(find(columns, name).value));
        CHECK_THAT(find(columns, name).note, Catch::Contains("does not fit"));
    }
    CHECK(find(columns, "eta_at_1").value == Approx(0.2));
    CHECK(find(columns, "peak_um").value == Approx(0.28));
}

TEST_CASE("every empty cell has a reason", "[summary]") {
    Case c = thesis_case();
    const auto check_notes = [](const std::vector<measures::Column>& columns) {
        for (const measures::Column& column : columns)
            if (std::isnan(column.value)) CHECK_FALSE(column.note.empty());
    };
    measures::DepthSeries still{.depth_m = 0.0, .frames = std::vector<measures::SurfaceSums>(280)};
    const measures::TraceSeries silent{.u_m = std::vector<double>(280, 0.0)};
    const auto at_rest =
        measures::summarise(c, {still}, {silent}, measures::MachFit{.reason = "too weak"});
    check_notes(at_rest);
    CHECK(find(at_rest, "eta_at_1").note == "nothing has moved");
    CHECK(find(at_rest, "peak_um").value == 0.0);
    CHECK(find(at_rest, "mach_angle_deg").note == "too weak");

    const auto nothing = measures::summarise(c, {}, {}, {});
    check_notes(nothing);
    CHECK(find(nothing, "eta_period_1").note == "no depth recorded");
    CHECK(find(nothing, "peak_um").note == "no depth recorded");
    CHECK(find(nothing, "peak_frequency_Hz").note == "no trace recorded");
    CHECK(find(nothing, "rms_5_300_um").note == "no trace recorded");

    c.measure.at_s = 20e-3;
    const auto beyond = measures::summarise(c, {growing(0.0, 280)}, {}, {});
    check_notes(beyond);
    CHECK(std::isnan(find(beyond, "eta_at_1").value));
    CHECK(std::isnan(find(beyond, "mach_angle_theory_deg").value)); // the path ends at 14 ms

    c.scene.load.modulation.trajectory = {{Hold{}}};
    CHECK(find(measures::summarise(c, {}, {}, {}), "mach_angle_theory_deg").note ==
          "the focus does not move");
}

TEST_CASE("the instant is the nearest frame, and a note states this", "[summary]") {
    Case c = thesis_case();
    c.measure.at_s = 10.02e-3;
    measures::DepthSeries series = growing(0.0, 280);
    series.frames[199].focal_u2 = 0.5 * series.frames[199].u2; // 10 ms
    const measures::Column eta = find(measures::summarise(c, {series}, {}, {}), "eta_at_1");
    CHECK(eta.value == Approx(0.5));
    CHECK(eta.note == "frame at 10 ms");
    CHECK(find(measures::summarise(c, {series}, {}, {}), "peak_um").value ==
          Approx(0.2)); // none later
}

TEST_CASE("there is no reading at an instant at which the focus jumps back to the start",
          "[summary]") {
    Case c = thesis_case();
    auto& travel = std::get<Travel>(c.scene.load.modulation.trajectory.parts[0]);
    travel.at_end = AtEnd::repeat; // 98 mm at 7 m/s end at 14 ms
    const auto read = [&] { return measures::summarise(c, {growing(0.0, 280)}, {}, {}); };
    const measures::Column jumps = find(read(), "eta_at_1");
    CHECK(std::isnan(jumps.value));
    CHECK(jumps.note.starts_with("the focus jumps at the instant, 14 ms"));
    CHECK(find(read(), "eta_period_1").value == Approx(0.2)); // 20 of 100 samples in the disc
    c.measure.at_s = 13e-3;
    CHECK(find(read(), "eta_at_1").value == Approx(0.2));
    c.measure.at_s = 14e-3;
    travel.at_end = AtEnd::back_and_forth;
    CHECK(find(read(), "eta_at_1").value == Approx(0.2));
}

TEST_CASE("further depths add columns that carry the depth", "[summary]") {
    const auto columns = measures::summarise(
        thesis_case(), {growing(0.0, 280), growing(1.5e-3, 280, 0.5), growing(4e-3, 280, 0.1)}, {},
        {});
    for (const measures::Column& column : columns)
        if (const auto suffix = column.name.find("_z1.5mm"); suffix != std::string::npos)
            for (const char* other : {"", "_z4mm"})
                find(columns, column.name.substr(0, suffix) + other);
    CHECK(find(columns, "peak_um_z1.5mm").value == Approx(0.14));
    CHECK(find(columns, "focal_rms_um_z4mm").value ==
          Approx(0.1 * find(columns, "focal_rms_um").value).epsilon(1e-12));
    CHECK(find(columns, "eta_period_1_z4mm").value == Approx(0.2));
}

TEST_CASE("the spectrum is that of the trace at the origin, else of the first", "[summary]") {
    const measures::TraceSeries aside = tone_at({3e-3, 0.0}, 500), centre = tone_at({}, 300);
    const measures::Column both =
        find(measures::summarise(thesis_case(), {}, {aside, centre}, {}), "peak_frequency_Hz");
    CHECK(both.value == Approx(300).margin(10));
    CHECK_THAT(both.long_name, Catch::Contains("at (0, 0) mm"));
    const measures::Column one =
        find(measures::summarise(thesis_case(), {}, {aside}, {}), "peak_frequency_Hz");
    CHECK(one.value == Approx(500).margin(10));
    CHECK_THAT(one.long_name, Catch::Contains("at (3, 0) mm"));
}

TEST_CASE("the strongest frequency is that of a tone on a larger mean", "[summary]") {
    measures::TraceSeries trace = tone_at({}, 300);
    for (double& value : trace.u_m)
        value += 10e-6; // ten times the tone; its leakage is larger than the tone below 130 Hz
    const auto columns = measures::summarise(thesis_case(), {}, {trace}, {});
    // Without the mean, the tone at the negative frequency shifts the maximum by less than 10 Hz.
    CHECK(find(columns, "peak_frequency_Hz").value == Approx(300).margin(10));
}

TEST_CASE("a band's share is that of the tones in it", "[summary]") {
    Case c = thesis_case();
    c.measure.bands = {{100.0, 500.0}, {500.0, 1000.0}, {0.0, 1e4}, {0.0, 2e4}};
    measures::TraceSeries trace = tone_at({}, 300);
    const measures::TraceSeries other = tone_at({}, 800);
    for (std::size_t i = 0; i < trace.u_m.size(); ++i)
        trace.u_m[i] += 0.5 * other.u_m[i];
    const auto columns = measures::summarise(c, {}, {trace}, {});
    // Tones of finite length leak past their bands' edges, 200 Hz away and more.
    CHECK(find(columns, "share_100_500_1").value == Approx(0.8).margin(0.02));
    CHECK(find(columns, "share_500_1000_1").value == Approx(0.2).margin(0.02));
    CHECK(find(columns, "share_0_10000_1").value == Approx(1.0)); // of all above 1/T
    // Velocity goes with the frequency: 300 against 0.5 times 800. It jumps where the run ends,
    // which leaks to all frequencies.
    CHECK(find(columns, "velocity_share_500_1000_1").value == Approx(0.64).margin(0.03));
    CHECK(find(columns, "peak_frequency_Hz").value == Approx(300).margin(10));
    CHECK(find(columns, "velocity_peak_frequency_Hz").value == Approx(800).margin(10));
    CHECK(find(columns, "share_0_20000_1").note == "frames every 50 us cannot represent 20000 Hz");
}

TEST_CASE("bands beyond the Nyquist frequency of the frames stay empty", "[summary]") {
    Case c = thesis_case();
    c.time = {.frames = 14, .interval_s = 1e-3};
    measures::TraceSeries trace{.u_m = std::vector<double>(14, 1e-6)};
    const auto columns = measures::summarise(c, {}, {trace}, {});
    CHECK(find(columns, "rms_40_400_um").note.empty());
    CHECK(find(columns, "rms_5_800_um").note == "frames every 1000 us cannot represent 800 Hz");
}

TEST_CASE("focal_rms_um leaves out the part of the path outside the measured region", "[summary]") {
    Case c = thesis_case();
    // The focus leaves the region, x < 0, at 7 ms. In frame n, u is n nm in the disc.
    c.measure.region_m = {{-80e-3, -50e-3}, {0.0, -50e-3}, {0.0, 50e-3}, {-80e-3, 50e-3}};
    const measures::Region region = measures::measured_region(c.domain, c.measure);
    measures::DepthSeries series{.depth_m = 0.0};
    std::vector<double> u(static_cast<std::size_t>(c.domain.nx * c.domain.ny));
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
        std::ranges::fill(u, 1e-9 * static_cast<double>(n + 1));
        series.frames.push_back(measures::surface_sums(
            {u.data(), c.domain.nx, c.domain.ny}, 0, c.domain, region,
            foci(c.scene.load.modulation, c.time.frame_s(n)).front(), c.measure.focal_radius_m));
    }
    const auto rms = find(measures::summarise(c, {series}, {}, {}), "focal_rms_um");
    // The integral of n^2 over the window from frame 80 to the frame at which a point of the disc
    // leaves: 140 on average, with the variance r^2 / 4 of the positions in a disc.
    const double radius = 3.0 / 0.35; // in frames
    const double mean =
        (std::pow(140.0, 3) + 3.0 * 140.0 * radius * radius / 4.0 - std::pow(80.0, 3)) / 3.0 / 60.0;
    // The trapezoidal rule adds 1/6 nm^2 to 12 400. The cells on the edge of the region leave as a
    // whole, within half of their width, 1.07 frames: 3 * 140 * 1.07^2 / 180 = 2.7 nm^2.
    CHECK(rms.value == Approx(1e-3 * std::sqrt(mean)).epsilon(1.2e-4));
    // 7 of the 10 ms of the window, which are two periods of 5 ms that end at 14 ms.
    CHECK(rms.note.find("70 % of the focal disc") == 0);

    // Completely outside: no value.
    for (Vec2& corner : c.measure.region_m)
        corner.y += 60e-3;
    for (measures::SurfaceSums& frame : series.frames)
        frame.focal_u2 = frame.focal_weight = 0.0;
    const auto none = find(measures::summarise(c, {series}, {}, {}), "focal_rms_um");
    CHECK(std::isnan(none.value));
    CHECK(none.note == "the focal disc is not inside the measured region");
}

TEST_CASE("overlapping focal discs inside the region leave nothing out", "[summary]") {
    Case c = thesis_case();
    c.scene.load.modulation.foci_m = {{-1e-3, 0.0}, {1e-3, 0.0}};
    const measures::Region region = measures::measured_region(c.domain, c.measure);
    const std::vector<double> u(static_cast<std::size_t>(c.domain.nx * c.domain.ny), 1e-9);
    measures::DepthSeries series{.depth_m = 0.0};
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
        series.frames.push_back(measures::surface_sums(
            {u.data(), c.domain.nx, c.domain.ny}, 0, c.domain, region,
            foci(c.scene.load.modulation, c.time.frame_s(n)), c.measure.focal_radius_m));
    REQUIRE(series.frames[200].focal_weight < 1.5 * disc_cells);
    const auto rms = find(measures::summarise(c, {series}, {}, {}), "focal_rms_um");
    CHECK(rms.value == Approx(1e-3).epsilon(1e-12));
    CHECK(rms.note.empty());
}

TEST_CASE("the columns of a stated region are the edges of what is measured", "[summary]") {
    Case c = thesis_case();
    c.domain = {.nx = 80, .ny = 80, .spacing_m = 1e-3};
    c.measure.region_m = {{-36e-3, -20.2e-3}, {36e-3, -20.2e-3}, {36e-3, 60e-3}, {-36e-3, 60e-3}};
    const auto columns = measures::summarise(c, {growing(0.0, 280)}, {}, {});
    const auto value = [&](const std::string& name) { return find(columns, name).value; };
    CHECK(value("region_from_x_mm") == Approx(-36.0).epsilon(1e-14));
    CHECK(value("region_to_x_mm") == Approx(36.0).epsilon(1e-14));
    CHECK(value("region_from_y_mm") == Approx(-20.2).epsilon(1e-14));
    CHECK(value("region_to_y_mm") == Approx(39.5).epsilon(1e-14)); // half a cell inside the domain
    CHECK(value("region_mm2") == Approx(72.0 * 59.7).epsilon(1e-12));
}

} // namespace test_summary
