// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/motion/trajectory.hpp"
#include "unit/config/jobs.hpp"

#include <cmath>
#include <numbers>

namespace test_path_reader {

using namespace shearwake;
using namespace shearwake::test;

constexpr double pi = std::numbers::pi;
constexpr const char* speed = "speed_m_s = 7\n";

static std::string stm(std::string_view path, std::string_view more = speed) {
    return with_modulation("kind = \"STM\"\n" + std::string(more) + "path = { " +
                           std::string(path) + " }");
}

static Modulation modulation_of(std::string_view modulation) {
    return only_case(with_modulation(modulation)).scene.load.modulation;
}

static Travel travel_of(std::string_view path, std::string_view more = speed) {
    return std::get<Travel>(
        only_case(stm(path, more)).scene.load.modulation.trajectory.parts.at(0));
}

TEST_CASE("paths are read in millimetres and degrees", "[config][path]") {
    const Travel circle = travel_of("shape = \"circle\", radius_mm = 10, start_deg = 90");
    CHECK(std::get<Arc>(circle.path.shape) == Arc{{}, 0.01, 0.5 * pi, 2.0 * pi});
    CHECK(circle.at_end == AtEnd::repeat);
    const Travel arc =
        travel_of("shape = \"arc\", center_mm = [1, 2], radius_mm = 10, sweep_deg = -90");
    CHECK(std::get<Arc>(arc.path.shape) == Arc{{0.001, 0.002}, 0.01, 0.0, -0.5 * pi});
    CHECK(arc.at_end == AtEnd::off);
    const Travel line = travel_of("shape = \"polyline\", points_mm = [[0, 0], [3, 0], [3, 4]]");
    CHECK(line.path == Curve(Polyline({{0, 0}, {0.003, 0}, {0.003, 0.004}}, Ends::open)));
    const Travel figure = travel_of(
        "shape = \"lissajous\", amplitudes_mm = [10, 5], frequencies = [3, 2], phase_deg = 90");
    CHECK(std::get<Lissajous>(figure.path.shape).shape() ==
          LissajousShape{{}, {0.01, 0.005}, 3, 2, 0.5 * pi});
}

TEST_CASE("a regular polygon stands on a side", "[config][path]") {
    const std::string size = GENERATE("side_mm = 20", "radius_mm = 14.142135623730951");
    const Travel square = travel_of("shape = \"polygon\", sides = 4, " + size);
    const auto& points_m = std::get<Polyline>(square.path.shape).points_m();
    REQUIRE(points_m.size() == 4);
    CHECK(norm(points_m[0] - Vec2{0.01, -0.01}) < 1e-16);
    CHECK(norm(points_m[2] - Vec2{-0.01, 0.01}) < 1e-16);
}

TEST_CASE("a draw frequency is the number of passes per second", "[config][path]") {
    const Travel circle =
        travel_of("shape = \"circle\", radius_mm = 10", "draw_frequency_Hz = 70\n");
    CHECK(cycle_s(circle) == Approx(1.0 / 70.0).epsilon(1e-14));
    const Travel line = travel_of(
        "shape = \"line\", from_mm = [-5, 0], to_mm = [5, 0], at_end = \"back-and-forth\"",
        "draw_frequency_Hz = 70\n");
    CHECK(cycle_s(line) == Approx(1.0 / 70.0).epsilon(1e-14));
    const Travel square =
        travel_of("shape = \"polygon\", sides = 4, side_mm = 20",
                  "draw_frequency_Hz = 5\ncorner_dwell_ms = 20\ncorner_slow_mm = 3\n"
                  "corner_slow_to = 0.5\n");
    CHECK(square.corners == CornerPace{0.02, 0.003, 0.5});
    CHECK(cycle_s(square) == Approx(0.2).epsilon(1e-14));
}

TEST_CASE("LM oscillates around its position", "[config][path]") {
    CHECK(modulation_of("kind = \"LM\"\nlm_amplitude_mm = 2\nlm_frequency_Hz = 90\n"
                        "position_mm = [1, 0]\nlm_wave = \"triangle\"\n") ==
          Modulation{"LM",
                     {{Hold{{0.001, 0.0}}, Swing{{0.002, 0.0}, 90.0, 0.0, SwingWave::triangle}}},
                     {}});
}

TEST_CASE("DTP is an AM point that moves along a path, STP a pattern that does", "[config][path]") {
    const std::string along = "path = { shape = \"polygon\", sides = 4, side_mm = 10 }\n"
                              "speed_m_s = 0.1\ncorner_dwell_ms = 30\n";
    const Modulation dtp = modulation_of("kind = \"DTP\"\nam_frequency_Hz = 500\n" + along);
    CHECK(dtp.envelope == Envelope{{SineGain{500.0}}});
    const std::string radius = GENERATE("0", "2");
    const Modulation stp = modulation_of("kind = \"STP\"\npattern_frequency_Hz = 500\n"
                                         "pattern = { shape = \"circle\", radius_mm = " +
                                         radius + " }\n" + along);
    CHECK(stp.envelope == Envelope{});
    for (const double t : {0.01, 0.0777, 0.4}) {
        const Vec2 off = position(stp.trajectory, t) - position(dtp.trajectory, t);
        const double r = radius == "2" ? 0.002 : 0.0, angle = 2.0 * pi * 500.0 * t;
        CHECK(norm(off - Vec2{r * std::cos(angle), r * std::sin(angle)}) < 1e-13);
    }
}

TEST_CASE("AM-STM of depth zero and SM-STM of deviation zero are STM", "[config][path]") {
    const std::string along = "path = { shape = \"circle\", radius_mm = 10 }\nspeed_m_s = 7\n";
    const Modulation plain = modulation_of("kind = \"STM\"\n" + along);
    const Modulation am =
        modulation_of("kind = \"AM-STM\"\nam_frequency_Hz = 500\nam_depth = 0\n" + along);
    const Modulation sm = modulation_of(
        "kind = \"SM-STM\"\nsm_frequency_Hz = 500\nspeed_deviation_m_s = 0\n" + along);
    for (const double t : {0.0, 0.0013, 0.0377}) {
        CHECK(position(am.trajectory, t) == position(plain.trajectory, t));
        CHECK(position(sm.trajectory, t) == position(plain.trajectory, t));
        CHECK(gain(am.envelope, t) == 1.0);
        CHECK(gain(sm.envelope, t) == 1.0);
    }
}

TEST_CASE("a custom modulation is any sum of moves and product of gains", "[config][path]") {
    const Modulation custom = modulation_of(R"(kind = "custom"
[[load.modulation.trajectory]]
move = "path"
path = { shape = "line", from_mm = [-5, 0], to_mm = [5, 0] }
speed_m_s = 2
[[load.modulation.trajectory]]
move = "swing"
amplitude_mm = [0, 1]
frequency_Hz = 600
[[load.modulation.envelope]]
shape = "sine"
frequency_Hz = 500
on = "pressure"
[[load.modulation.envelope]]
shape = "square"
frequency_Hz = 400
[[load.modulation.envelope]]
shape = "window"
to_ms = 3
edge_us = 500
[[load.modulation.envelope]]
shape = "ramp"
duration_ms = 2
from = 0.5)");
    CHECK(custom.trajectory ==
          Trajectory{{Travel{{{-0.005, 0.0}, {0.005, 0.0}}, ConstantSpeed{2.0}},
                      Swing{{0.0, 0.001}, 600.0}}});
    REQUIRE(custom.envelope.gains.size() == 4);
    CHECK(custom.envelope.gains[0] == Gain(SineGain{500.0, 1.0, 0.0, GainOn::pressure}));
    CHECK(custom.envelope.gains[1] == Gain(SquareGain{.frequency_Hz = 400.0, .edge_s = 250e-6}));
    CHECK(custom.envelope.gains[2] == Gain(WindowGain{0.0, 0.003, 0.0005}));
    CHECK(custom.envelope.gains[3] == Gain(RampGain{.duration_s = 0.002, .from = 0.5}));
}

TEST_CASE("every part of a custom modulation can be swept", "[config][path]") {
    const std::string job = with_modulation(R"(kind = "custom"
[[load.modulation.trajectory]]
move = "swing"
amplitude_mm = [0, 1]
frequency_Hz = 500
[[load.modulation.envelope]]
shape = "sine"
frequency_Hz = 500)") + R"([sweep]
"load.modulation.envelope[1].depth" = [0.5, 1.0]
"load.modulation.trajectory[1].frequency_Hz" = [500, 600]
)";
    const config::Job read = config::read_job(job, "job.toml");
    REQUIRE(read.plan.cases.size() == 4);
    const Modulation& last = read.plan.cases[1].physics.scene.load.modulation;
    CHECK(std::get<Swing>(last.trajectory.parts[0]).frequency_Hz == 600.0);
    CHECK(std::get<SineGain>(last.envelope.gains[0]).depth == 0.5);
}

TEST_CASE("a path can come from a file of points", "[config][path]") {
    const std::string job = stm("shape = \"csv\", file = \"shape.csv\"");
    const config::Job read =
        config::read_job(job, "job.toml", {}, nullptr, [](const std::string& file) {
            CHECK(file == "shape.csv");
            return "# mine\nx_mm,y_mm\n0, 0\r\n\n3,0\n3,4\n";
        });
    const auto& parts = read.plan.cases.at(0).physics.scene.load.modulation.trajectory.parts;
    CHECK(std::get<Travel>(parts[0]).path ==
          Curve(Polyline({{0, 0}, {0.003, 0}, {0.003, 0.004}}, Ends::open)));
}

/// The path of a file with such a text.
static Travel travel_of_file(const std::string& csv, std::string_view path = "",
                             std::string_view more = "") {
    const config::Job read =
        config::read_job(stm("shape = \"csv\", file = \"a.csv\"" + std::string(path), more),
                         "job.toml", {}, nullptr, [&](const std::string&) { return csv; });
    return std::get<Travel>(
        read.plan.cases.at(0).physics.scene.load.modulation.trajectory.parts.at(0));
}

TEST_CASE("a focus rests at the points of a file with times", "[config][path]") {
    // Six of eight points lie within a millimetre: they have 75 % of the time.
    std::string csv = "x_mm,y_mm,dwell_ms,level\n";
    for (const char* point : {"0,0", "0.2,0", "0.4,0", "0.6,0", "0.8,0", "1,0", "20,0", "20,20"})
        csv += std::string(point) + ",5,0.5\n";
    const Travel travel = travel_of_file(csv);
    int near = 0;
    for (int n = 0; n < 400; ++n) {
        const Vec2 at = position({{travel}}, (n + 0.5) * 1e-4);
        near += norm(at) < 1.001e-3 ? 1 : 0;
    }
    CHECK(near == 300);
    CHECK(level({{travel}}, 0.012) == 0.5);
    CHECK(off_time_s({{travel}}) == Approx(0.040));

    const Travel times = travel_of_file("x_mm,y_mm,t_ms\n+3,0,0\n+3.0,0,1\n1,4,2.5\n");
    const auto& rests = std::get<Rests>(times.motion);
    // Equal points prolong the rest; the last rest is as long as the one before it.
    CHECK(rests.ends_s == std::vector{0.001, 0.0025, 0.004});
    CHECK(rests.arcs_m[0] == rests.arcs_m[1]);
    CHECK(position({{times}}, 0.0024) == Vec2{0.003, 0.0});
    CHECK(position({{times}}, 0.0026) == Vec2{0.001, 0.004});
    const Travel closed =
        travel_of_file("x_mm,y_mm,t_s\n0,0,0\n3,0,1\n3,4,2\n0,0,3\n", ", closed = true");
    CHECK(closed.at_end == AtEnd::repeat);
    CHECK(std::get<Rests>(closed.motion).arcs_m.back() == 0.0);
}

TEST_CASE("an error in a file of points is reported with its line", "[config][path]") {
    const auto [csv, said] = GENERATE(table<std::string, std::string>({
        {"x_mm,y_mm\n1,2\n", "must contain at least 2 points below a header that names its"},
        {"0,0\n1,1\n", "line 1: must name two columns and their unit, as in x_mm,y_mm"},
        {"x_mm,y_mm\n0,0\n1\n", "line 3: must be two finite numbers x,y, but is \"1\""},
        {"x_mm,y_mm\n0,0\n1e999,1\n", "line 3: must be two finite numbers x,y, but is \"1e999,1\""},
        {"x_mm,y_mm\n0,0\n0,0\n", "line 3: repeats the previous point"},
        {"x_mm,y_mm\n0,5,1,5\n2,5,1,5\n", "line 2: has 4 cells, but the first row has 2; write"},
        {"x_mm;y_mm\n0;1\n0,5;1\n", "line 3: has the number \"0,5\" with a decimal comma; write"},
    }));
    check_only(diagnostics_with_file(stm("shape = \"csv\", file = \"shape.csv\""), csv),
               error_at("19:32 load.modulation.path.file cannot be used: shape.csv: " + said));
}

TEST_CASE("errors in a file of points with times are reported", "[config][path]") {
    const auto [csv, more, said] = GENERATE(table<std::string, std::string, std::string>({
        {"x_mm,y_mm,t_ms\n0,0,0\n1,0,2\n2,0,2\n", "", "that of point 3 does not"},
        {"x_mm,y_mm,t_ms\n0,0,1\n1,0,2\n", "", "the first time must be 0"},
        {"x_mm,y_mm,dwell_ms\n0,0,1\n1,0,0\n", "", "line 3: has a dwell"},
        {"x_mm,y_mm,dwell_ms,level\n0,0,1,2\n1,0,1,1\n", "", "between 0 and 1"},
        {"x_mm,y_mm,level\n0,0,1\n1,0,1\n", "", "dwell_ms or t_ms, and then level"},
        {"x_mm,y_mm,dwell_mm\n0,0,1\n1,0,1\n", "", "line 1: must name"},
        {"x_mm,y_mm,dwell_ms\n0,0,1\n1,0,1\n", speed, "speed_m_s does not apply, since the file"},
        // One error: the file may state times, which replace the speed.
        {"x_mm,y_mm,dwell_ms\n0,0,1\n1,0,nan\n", "", "line 3"},
    }));
    const Texts found = diagnostics_with_file(stm("shape = \"csv\", file = \"a.csv\"", more), csv);
    CAPTURE(found);
    CHECK(any_contains(found, said));
    if (more.empty()) CHECK_FALSE(any_contains(found, "speed_m_s"));
}

TEST_CASE("an error in a path is reported with its location", "[config][path]") {
    const auto [path, more, said] = GENERATE(table<std::string, std::string, std::string>({
        {"shap = \"circle\", radius_mm = 5", speed, "path.shape is missing; shap is unknown"},
        {"shape = \"polyline\", points_mm = [[0, 0], [1, 0], [1, 0]]", speed,
         "path.points_mm has points 2 and 3 at the same position"},
        {"shape = \"lissajous\", amplitudes_mm = [9, 9], frequencies = [4, 2]", speed,
         "path.frequencies have the common factor 2, so the figure would be drawn 2 times; [2"},
        {"shape = \"csv\", file = \"a.csv\"", speed, "path.file names a file, but this job"},
        {"shape = \"circle\", radius_mm = 5", "speed_m_s = 7\ndraw_frequency_Hz = 9\n",
         "draw_frequency_Hz and a speed are both given; remove one of them from the job"},
        {"shape = \"circle\", radius_mm = 5", "speed_m_s = 7\ncorner_dwell_ms = 1\n",
         "corner_dwell_ms does not apply to a path that has no corners and is not traversed back"},
        {"shape = \"polygon\", sides = 4, side_mm = 20",
         "speed_m_s = 7\ncorner_slow_mm = 11\ncorner_slow_to = 0.5\n",
         "corner_slow_mm must be at most 10, half of the shortest distance between two corners "
         "along the path, but is 11"},
        {"shape = \"polygon\", sides = 4, side_mm = 20", "speed_m_s = 7\ncorner_slow_mm = 5\n",
         "corner_slow_mm requires the other of corner_slow_mm (distance over which the focus"},
        {"shape = \"polygon\", sides = 4, side_mm = 20",
         "draw_frequency_Hz = 100\ncorner_dwell_ms = 3\n",
         "draw_frequency_Hz leaves 10 ms per pass along the path, but the 4 corners take 3 ms "
         "each"},
    }));
    check_only(diagnostics_of(stm(path, more)), "error: load.modulation." + said);
}

TEST_CASE("an error in a custom modulation is reported with its location", "[config][path]") {
    const auto [more, said] = GENERATE(table<std::string, std::string>({
        {"trajectory = []", "trajectory must be a list of at least one table"},
        {"trajectory = [{ move = \"hold\", position_mm = [0, 0] }]\n"
         "envelope = [{ shape = \"square\", frequency_Hz = 500, edge_us = 1500 }]",
         "envelope[1].edge_us must be at most 1000, the shorter part of a period, but is 1500"},
        {"trajectory = [{ move = \"hold\", position_mm = [0, 0] }]\n"
         "envelope = [{ shape = \"window\", from_ms = 3, to_ms = 2 }]",
         "envelope[1].to_ms must be after from_ms = 3, but is 2"},
        {"trajectory = [{ move = \"hold\", position_mm = [0, 0] }]\nspeed_m_s = 3",
         "speed_m_s does not apply to kind custom"},
    }));
    check_only(diagnostics_of(with_modulation("kind = \"custom\"\n" + more)),
               "error: load.modulation." + said);
}

} // namespace test_path_reader
