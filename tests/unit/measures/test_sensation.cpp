// SPDX-License-Identifier: BSD-3-Clause
#include "measures/sensation.hpp"
#include "measures/summary.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace test_sensation {

using namespace shearwake;

constexpr double two_pi = 2.0 * std::numbers::pi;

/// AM at 100 Hz at rest, 10 ms in the periodic regime; 40 mm in steps of 1 mm.
static Case periodic_case() {
    Case c;
    c.scene.medium = {
        .layers = {
            {.thickness_m = 0.02, .density_kg_m3 = 1000.0, .c_p_m_s = 1500.0, .c_s_m_s = 5.0}}};
    c.scene.load = {.peak_Pa = 100.0, .footprint = GaussianFootprint{.fwhm_m = 4e-3}};
    c.scene.load.modulation = {
        .kind = "AM", .trajectory = {{Hold{}}}, .envelope = {{SineGain{.frequency_Hz = 100.0}}}};
    c.domain = {.nx = 40, .ny = 40, .spacing_m = 1e-3};
    c.time = {.frames = 100, .interval_s = 100e-6, .regime = Regime::periodic};
    c.measure = {.at_s = 10e-3, .focal_radius_m = 4e-3};
    return c;
}

/// u_z [m] at a place and time.
using Motion = std::function<double(Vec2, double)>;

/// The levels of some rows; with `in_pieces`, the sums are flushed as a checkpoint does.
static measures::SensationMap map_of_rows(const Case& c, const Motion& u_m, std::ptrdiff_t first,
                                          std::ptrdiff_t rows, bool in_pieces) {
    measures::SensationSums sums(c, first, rows);
    std::vector<double> plane;
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
        plane.clear();
        for (std::ptrdiff_t i = first; i < first + rows; ++i)
            for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j)
                plane.push_back(u_m({c.domain.x_m(i), c.domain.y_m(j)}, c.time.frame_s(n)));
        sums.add(n, View2<const double>(plane.data(), rows, c.domain.ny));
        if (in_pieces && n % 7 == 0) sums.flush();
    }
    CHECK(sums.first_row() == first);
    return sums.levels();
}
static measures::SensationMap map_of(const Case& c, const Motion& u_m) {
    return map_of_rows(c, u_m, 0, c.domain.nx, false);
}

static double column(const Case& c, const measures::SensationMap& map, const std::string& name) {
    const auto columns = measures::sensation_columns(c, map);
    const auto found = std::ranges::find(columns, name, &measures::Column::name);
    REQUIRE(found != columns.end());
    CHECK(std::isnan(found->value) == (std::isnan(found->value) && !found->note.empty()));
    return found->value;
}

/// A motion with this rms acceleration and frequency.
static double tone_m(double rms_m_s2, double f_Hz, double t_s) {
    return std::numbers::sqrt2 * rms_m_s2 / std::pow(two_pi * f_Hz, 2) *
           std::cos(two_pi * f_Hz * t_s + 0.7);
}

TEST_CASE("the level of a plane that oscillates is that of its acceleration", "[sensation]") {
    const Case c = periodic_case();
    const auto map = map_of(c, [](Vec2, double t) { return 1e-5 + tone_m(0.23, 100.0, t); });
    REQUIRE(map.level_dB.size() == 1600);
    // 0.023 m/s^2 is the threshold at 100 Hz. 1e-9 dB: rounding of sums over 100 frames.
    for (const double level : map.level_dB)
        CHECK(level == Approx(20.0).margin(1e-9));
    CHECK(map.sum_dB.front() == Approx(20.0).margin(1e-9));
    CHECK(column(c, map, "felt_peak_dB") == Approx(20.0).margin(1e-9));
    CHECK(column(c, map, "felt_path_dB") == Approx(20.0).margin(1e-9));
    CHECK(column(c, map, "felt_band_Hz") == 100.0);
    CHECK(column(c, map, "felt_area_mm2") == Approx(1600.0));
    CHECK(column(c, map, "felt_contrast_dB") == Approx(0.0).margin(1e-9));
    CHECK(std::isnan(column(c, map, "felt_width_mm"))); // the level does not fall
    // Two bands add up in the rival level only.
    const auto two =
        map_of(c, [](Vec2, double t) { return tone_m(0.23, 100.0, t) + tone_m(0.29, 200.0, t); });
    CHECK(two.level_dB.front() == Approx(20.0).margin(1e-9));
    CHECK(two.sum_dB.front() == Approx(20.0 + 10.0 * std::log10(2.0)).margin(1e-9));
}

TEST_CASE("bands end at the exact edges of third octaves, and beyond the table nothing is felt",
          "[sensation]") {
    const auto bands = measures::sensation_bands();
    REQUIRE(bands.size() == 19);
    CHECK(bands.front().low_Hz == 8.0);
    CHECK(bands.back().high_Hz == 500.0);
    for (std::size_t b = 1; b < bands.size(); ++b)
        CHECK(bands[b].low_Hz == Approx(bands[b - 1].high_Hz).epsilon(1e-14)); // rounding
    CHECK(bands[11].centre_Hz == 100.0);
    CHECK(bands[11].low_Hz == Approx(100.0 / std::pow(10.0, 0.05)));
    CHECK(bands[17].is_extrapolated);
    CHECK_FALSE(bands[16].is_extrapolated);
    // The slope between 160 and 315 Hz: a factor of 61/21 in three third octaves.
    // Thresholds between the centres: log a is linear in log f.
    const auto threshold = [](double f_Hz) {
        return measures::sensation_lines(periodic_case()).threshold_m_s2(f_Hz);
    };
    CHECK(threshold(89.0) ==
          Approx(0.028 * std::pow(0.023 / 0.028, std::log(89.0 / 80.0) / std::log(100.0 / 80.0))));
    CHECK(threshold(125.0) == Approx(0.022).epsilon(1e-14)); // rounding
    CHECK(bands[17].threshold_m_s2 == Approx(0.061 * std::pow(61.0 / 21.0, 1.0 / 3.0)));
    CHECK(bands[18].threshold_m_s2 == Approx(0.061 * std::pow(61.0 / 21.0, 2.0 / 3.0)));

    Case c = periodic_case();
    c.scene.load.modulation.envelope = {{SineGain{.frequency_Hz = 1.0}}};
    c.time = {.frames = 2000, .interval_s = 500e-6, .regime = Regime::periodic};
    c.domain.nx = c.domain.ny = 4;
    struct Line {
        double f_Hz, centre_Hz;
    };
    const auto line = GENERATE(Line{89.0, 80.0}, Line{90.0, 100.0}, Line{112.0, 100.0},
                               Line{113.0, 125.0}, Line{8.0, 8.0}, Line{500.0, 500.0});
    const auto map = map_of(c, [&](Vec2, double t) { return tone_m(1.0, line.f_Hz, t); });
    CHECK(map.band_Hz.front() == line.centre_Hz);
    CHECK(map.level_dB.front() == Approx(-20.0 * std::log10(threshold(line.f_Hz))).margin(1e-8));
    // No other band has a part: the sum is the largest one.
    CHECK(map.sum_dB.front() == Approx(map.level_dB.front()).margin(1e-8));
    for (const double f_Hz : {7.0, 501.0}) {
        const auto none = map_of(c, [&](Vec2, double t) { return tone_m(1.0, f_Hz, t); });
        CHECK(std::isnan(none.level_dB.front()));
        CHECK_THAT(measures::sensation_columns(c, none).front().note,
                   Catch::Contains("nothing moves between 8 and 500 Hz"));
    }
}

TEST_CASE("the level of a tone is a continuous function of its frequency", "[sensation]") {
    // The largest slope of the threshold, 4.5 dB from 31.5 to 40 Hz, is 0.053 dB per 0.1 Hz.
    constexpr double largest_change_dB = 0.1; // required
    Case c = periodic_case();
    c.domain.nx = c.domain.ny = 2;
    const auto level_dB = [&](double f_Hz) {
        c.scene.load.modulation.envelope = {{SineGain{.frequency_Hz = f_Hz}}};
        c.time = {.frames = 64, .interval_s = 1.0 / (64.0 * f_Hz), .regime = Regime::periodic};
        return map_of(c, [&](Vec2, double t) { return tone_m(1.0, f_Hz, t); }).level_dB.front();
    };
    double before_dB = level_dB(20.0);
    for (int n = 201; n <= 4999; ++n) {
        const double f_Hz = 0.1 * n, now_dB = level_dB(f_Hz);
        INFO(f_Hz);
        REQUIRE(std::abs(now_dB - before_dB) < largest_change_dB);
        before_dB = now_dB;
    }
}

TEST_CASE("a window of a signal has the level of its lines", "[sensation]") {
    const Case steady = periodic_case();
    Case run = steady;
    run.measure.sensation = Sensation::on;
    run.time = {.frames = 1000, .interval_s = 100e-6};
    run.measure.at_s = 100e-3;
    run.measure.settled_after_s = 25e-3;
    const Motion motion = [](Vec2, double t) {
        return tone_m(0.05, 100.0, t) + tone_m(0.2, 300.0, t);
    };
    const auto lines = map_of(steady, motion);
    SECTION("whole periods, with an offset and a drift that acceleration does not contain") {
        const auto window =
            map_of(run, [&](Vec2 at, double t) { return 1e-5 + 1e-4 * t + motion(at, t); });
        CHECK(measures::sensation_lines(run).window_s == Approx(70e-3));
        CHECK(window.level_dB.front() == Approx(lines.level_dB.front()).margin(1e-6));
        CHECK(window.sum_dB.front() == Approx(lines.sum_dB.front()).margin(1e-6));
    }
    SECTION("periods between frames") {
        run.time = {.frames = 1307, .interval_s = 76.5e-6}; // 130.7 frames a period
        run.measure.at_s = run.time.duration_s();
        run.measure.settled_after_s = 26e-3;
        const auto window = map_of(run, motion);
        CHECK(window.level_dB.front() == Approx(lines.level_dB.front()).margin(0.1)); // required
    }
}

TEST_CASE("a window of whole periods has the exact levels of short runs", "[sensation]") {
    Case run = periodic_case();
    run.domain.nx = run.domain.ny = 4;
    struct Run {
        double f_Hz, duration_s;
    };
    // From one to a few periods between a quarter of the run and its end.
    const auto [f_Hz, duration_s] = GENERATE(Run{200.0, 14e-3}, Run{200.0, 7e-3}, Run{100.0, 14e-3},
                                             Run{50.0, 28e-3}, Run{20.0, 70e-3}, Run{400.0, 4e-3});
    run.scene.load.modulation.envelope.gains = {SineGain{.frequency_Hz = f_Hz}};
    run.measure.sensation = Sensation::on;
    run.time = {.frames = std::lround(duration_s / 50e-6), .interval_s = 50e-6};
    run.measure.at_s = duration_s;
    run.measure.settled_after_s = 0.25 * duration_s;
    const auto map = map_of(run, [&, f = f_Hz](Vec2, double t) { return tone_m(1.0, f, t); });
    const auto lines = measures::sensation_lines(run);
    CHECK(lines.reason.empty());
    // Rounding of a second difference of a parabola of 1e-6 m.
    CHECK(map.level_dB.front() ==
          Approx(-20.0 * std::log10(lines.threshold_m_s2(f_Hz))).margin(1e-6));
}

TEST_CASE("a window that cannot judge its load has no level, with the reason", "[sensation]") {
    Case run = periodic_case();
    run.measure.sensation = Sensation::on;
    run.time = {.frames = 280, .interval_s = 50e-6};
    run.measure.at_s = 14e-3;
    run.measure.settled_after_s = 3.5e-3;
    auto& modulation = run.scene.load.modulation;
    const auto reason = [&] { return measures::sensation_lines(run).reason; };
    const auto sine = [](double f_Hz) { return SineGain{.frequency_Hz = f_Hz}; };
    const auto line = [](AtEnd at_end, double speed_m_s) {
        return Travel{.path = {Vec2{-20e-3, 0.0}, Vec2{20e-3, 0.0}},
                      .motion = ConstantSpeed{speed_m_s},
                      .at_end = at_end};
    };
    struct Modulated {
        std::vector<Gain> gains;
        std::string reason; // its beginning or end
        Mover motion = Hold{};
    };
    const Modulated loads[] = {
        {{sine(100.0)}, ""},
        {{sine(501.0)}, "the load has no line between 8 and 500 Hz"},
        {{SampledGain{.values = {1.0, 0.2}, .interval_s = 3e-3, .repeat = true}}, ""},
        // Products have lines at differences of frequencies, so a common period decides.
        {{sine(700.0), sine(900.0)}, ""}, // 10 ms
        {{sine(110.0), sine(173.0)}, "110 and 173 Hz, which have no common period"},
        // A ramp that has ended does not count, unless it has switched the load off.
        {{sine(100.0), RampGain{.duration_s = 3.5e-3}}, ""},
        {{sine(100.0), RampGain{.duration_s = 10e-3}},
         "it rises or falls once; choose times after that"},
        {{sine(100.0), RampGain{.duration_s = 1e-3, .from = 1.0, .to = 0.0}}, "the load is off"},
        {{sine(100.0), WindowGain{.to_s = 3e-3, .edge_s = 1e-3}}, "the load is off"},
        {{sine(100.0), WindowGain{.to_s = 30e-3, .edge_s = 1e-3}}, ""},
        {{}, "the load does not change"},
        {{}, "its path ends; set path.at_end", line(AtEnd::hold, 4.0)},
        {{}, "the motion of the focus at 50 Hz needs 20 ms", line(AtEnd::back_and_forth, 4.0)},
        {{}, "", line(AtEnd::back_and_forth, 8.0)},
        {{sine(50.0)}, "AM at 50 Hz needs 20 ms"},
        {{sine(100.0)}, "", line(AtEnd::hold, 20.0)}}; // it rests after 2 ms
    for (const Modulated& load : loads) {
        modulation.envelope.gains = load.gains;
        modulation.trajectory.parts = {load.motion};
        CHECK(reason().empty() == load.reason.empty());
        CHECK_THAT(reason(), Catch::Contains(load.reason));
        for (const auto& felt : measures::sensation_columns(run, {}))
            if (!load.reason.empty()) CHECK(felt.note == reason());
    }
    run.measure.settled_after_s = 13.9e-3;
    CHECK_THAT(reason(), Catch::StartsWith("fewer than four frames"));
}

/// Spots with Gaussian profiles of 4 mm standard deviation, and of 2 mm in the middle.
static measures::SensationMap spots(const Case& c, const std::vector<Vec2>& at_m,
                                    double middle = 0.0) {
    return map_of(c, [&](Vec2 place, double t) {
        double sum = middle * std::exp(-0.5 * std::pow(norm(place) / 2e-3, 2));
        for (const Vec2 spot : at_m)
            sum += std::exp(-0.5 * std::pow(norm(place - spot) / 4e-3, 2));
        return sum * tone_m(0.23, 100.0, t);
    });
}

static Case two_foci(double distance_m) {
    Case c = periodic_case();
    c.domain = {.nx = 80, .ny = 60, .spacing_m = 1e-3};
    c.scene.load.modulation.foci_m = {{-0.5 * distance_m, 0.0}, {0.5 * distance_m, 0.0}};
    return c;
}

TEST_CASE("two distant foci have two maxima with the dip of their profiles", "[sensation]") {
    const Case far = two_foci(32e-3), near = two_foci(6e-3);
    const auto two = spots(far, far.scene.load.modulation.foci_m);
    CHECK(column(far, two, "felt_peaks_1") == 2.0);
    // In the middle 2 exp(-8), at a spot 1.
    const double dip_dB = 20.0 * std::log10(std::exp(8.0) / 2.0);
    CHECK(column(far, two, "felt_gap_dB") == Approx(dip_dB).margin(1e-6));
    // Where their waves meet, another maximum may lie far below them. It does not count.
    const double middle = GENERATE(0.1, 0.4, 0.6); // 6 dB are 0.501
    const auto waves = spots(far, far.scene.load.modulation.foci_m, middle);
    CHECK(column(far, waves, "felt_peaks_1") == (middle > 0.501 ? 3.0 : 2.0));
    const auto one = spots(near, near.scene.load.modulation.foci_m);
    CHECK(column(near, one, "felt_peaks_1") == 1.0);
    CHECK(column(near, one, "felt_gap_dB") == 0.0);
    // Equal maxima whose dip is not noticeable are one. The largest samples are 1 mm inside the
    // foci.
    const Case close = two_foci(10e-3);
    const auto flat = spots(close, close.scene.load.modulation.foci_m);
    CHECK(column(close, flat, "felt_peaks_1") == 1.0);
    const auto spot = [](double x_mm) { return std::exp(-x_mm * x_mm / 32.0); };
    CHECK(column(close, flat, "felt_gap_dB") ==
          Approx(20.0 * std::log10((spot(1.0) + spot(9.0)) / (2.0 * spot(5.0)))).margin(1e-6));
    Case along = near;
    along.sensation = SensationOptions{.line_m = {{0.0, -24e-3}, {0.0, 24e-3}}};
    CHECK(column(along, spots(along, {{0.0, -16e-3}, {0.0, 0.0}, {0.0, 16e-3}}), "felt_peaks_1") ==
          3.0);
}

TEST_CASE("the width is that of the profile at one just noticeable difference", "[sensation]") {
    Case c = periodic_case();
    c.domain = {.nx = 160, .ny = 160, .spacing_m = 0.25e-3};
    const auto map = spots(c, {{0.0, 0.0}});
    // exp(-r^2/2s^2) falls by J dB at r = s sqrt(J ln(10) / 10). Straight lines between samples of
    // 0.25 mm miss a parabola by h^2/8r = 0.002 mm.
    const auto width = [](double drop_dB) {
        return 8.0 * std::sqrt(drop_dB * std::numbers::ln10 / 10.0);
    };
    CHECK(column(c, map, "felt_width_mm") == Approx(width(2.3)).margin(0.01));
    CHECK(column(c, map, "felt_width_low_mm") == Approx(width(1.65)).margin(0.01));
    CHECK(column(c, map, "felt_width_high_mm") == Approx(width(2.98)).margin(0.01));
    // 20 dB above the threshold: the circle where exp(-r^2/2s^2) = 0.1; cells of 0.06 mm^2.
    CHECK(column(c, map, "felt_area_mm2") ==
          Approx(std::numbers::pi * 32.0 * std::numbers::ln10).epsilon(0.01));
    // All that is less than 6 dB below the peak lies within 4.7 mm, of which 4 mm count as near.
    CHECK(column(c, map, "felt_on_path_1") ==
          Approx(16.0 / (32.0 * 0.3 * std::numbers::ln10)).epsilon(0.01));
}

TEST_CASE("the width of a line is measured across it", "[sensation]") {
    Case c = periodic_case();
    c.domain = {.nx = 160, .ny = 160, .spacing_m = 0.25e-3};
    const bool is_along_x = GENERATE(true, false);
    const Vec2 end = is_along_x ? Vec2{12e-3, 0.0} : Vec2{0.0, 12e-3};
    c.scene.load.modulation.trajectory = {
        {Travel{.path = {-1.0 * end, end}, .motion = ConstantSpeed{2.4}}}};
    const auto map = map_of(c, [&](Vec2 at, double t) {
        const double across_m = is_along_x ? at.y : at.x;
        return std::exp(-0.5 * std::pow(across_m / 4e-3, 2)) * tone_m(0.23, 100.0, t);
    });
    CHECK(column(c, map, "felt_width_mm") ==
          Approx(8.0 * std::sqrt(2.3 * std::numbers::ln10 / 10.0)).margin(0.01));
}

TEST_CASE("levels do not change when the problem is rotated or mirrored", "[sensation]") {
    Case c = two_foci(20e-3);
    c.domain = {.nx = 61, .ny = 61, .spacing_m = 1e-3}; // symmetric about the origin
    const std::vector<Vec2> at = {{-10e-3, 2e-3}, {10e-3, 0.0}};
    c.scene.load.modulation.foci_m = at;
    const auto columns = measures::sensation_columns(c, spots(c, at));
    const auto turn = GENERATE(0, 1);
    std::vector<Vec2> moved;
    for (const Vec2 p : at)
        moved.push_back(turn == 0 ? Vec2{-p.y, p.x} : Vec2{p.x, -p.y});
    Case other = c;
    other.scene.load.modulation.foci_m = moved;
    const auto changed = measures::sensation_columns(other, spots(other, moved));
    REQUIRE(changed.size() == columns.size());
    for (std::size_t i = 0; i < columns.size(); ++i) {
        INFO(columns[i].name);
        // 1e-9: rounding of the positions of samples.
        CHECK(((std::isnan(columns[i].value) && std::isnan(changed[i].value)) ||
               changed[i].value == Approx(columns[i].value).epsilon(1e-9).margin(1e-9)));
    }
}

TEST_CASE("sums of slabs in pieces are those of the whole", "[sensation]") {
    const Case c = periodic_case();
    const Motion motion = [](Vec2 at, double t) { return tone_m(1.0 + 10.0 * at.x, 100.0, t); };
    const auto all = map_of(c, motion), some = map_of_rows(c, motion, 13, 9, true);
    REQUIRE(some.level_dB.size() == 9 * 40);
    CHECK(std::equal(some.level_dB.begin(), some.level_dB.end(), all.level_dB.begin() + 13 * 40));
}

TEST_CASE("an empty level has a reason", "[sensation]") {
    Case c = periodic_case();
    const auto reason = [&] { return measures::sensation_lines(c).reason; };
    CHECK(reason().empty());
    c.measure.depths_m = {1e-3};
    CHECK(reason() == "measure.depths_mm does not contain 0, the surface");
    c.measure.depths_m = {0.0};
    c.time.frames = 8;
    c.time.interval_s = 1.25e-3;
    CHECK(reason() == "frames every 1250 us cannot represent 500 Hz");
    c.time = {.frames = 20, .interval_s = 50e-6, .regime = Regime::periodic}; // 1000 Hz
    CHECK(reason() == "the load has no line between 8 and 500 Hz");
    for (const auto& felt : measures::sensation_columns(c, {}))
        CHECK(std::isnan(felt.value));
    c.measure.sensation = Sensation::off;
    CHECK(measures::sensation_columns(c, {}).empty());
}

TEST_CASE("a table of the user replaces the threshold", "[sensation]") {
    Case c = periodic_case();
    c.sensation = SensationOptions{.threshold = {{100.0, 0.23}, {125.0, 1.0}}};
    const auto map = map_of(c, [](Vec2, double t) {
        return tone_m(0.23, 100.0, t) + tone_m(50.0, 200.0, t); // 200 Hz is not in the table
    });
    CHECK(map.level_dB.front() == Approx(0.0).margin(1e-9));
}

} // namespace test_sensation
