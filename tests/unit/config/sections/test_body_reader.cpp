// SPDX-License-Identifier: BSD-3-Clause
#include "unit/config/jobs.hpp"

namespace test_body_reader {

using namespace shearwake;
using namespace shearwake::test;

/// The plain job for the engine that takes bodies. What is added stands from line 28 on.
static std::string job_with(const std::string& more) {
    return replaced(plain_and(more), "[job]", "solver = { engine = \"spectral\" }\n[job]");
}

constexpr const char* ball = R"([[medium.body]]
shape = "ellipsoid"
center_mm = [1.0, 2.0, 10.0]
semi_axes_mm = [3.0, 4.0, 5.0]
c_s_m_s = 9.0
)";

/// `ball` with its second line and those after it replaced.
static std::string body_of(const std::string& lines) {
    return job_with("[[medium.body]]\n" + lines);
}

const std::string upright = "shape = \"cylinder\"\ncenter_mm = [0, 0, 9]\nradius_mm = 3\n"
                            "c_s_m_s = 9\n";

static Body only_body(const std::string& job) {
    const auto bodies = only_case(job).scene.medium.bodies;
    REQUIRE(bodies.size() == 1);
    return bodies[0];
}

static std::shared_ptr<const MaterialMap> small_map(double c_s_m_s) {
    MaterialMap map{.counts = {1, 1, 1}, .c_s_m_s = {c_s_m_s}};
    map.content_hash = hash_of(map);
    return std::make_shared<const MaterialMap>(map);
}

TEST_CASE("each shape is read in SI", "[config][body]") {
    const Body ellipsoid = only_body(job_with(ball));
    CHECK(ellipsoid.name == "body 1");
    CHECK(std::get<Ellipsoid>(ellipsoid.shape) == Ellipsoid{{0.003, 0.004, 0.005}});
    CHECK(ellipsoid.centre_m == Vec3{0.001, 0.002, 0.01});
    CHECK(ellipsoid.c_s_m_s == 9.0);
    CHECK_FALSE(ellipsoid.density_kg_m3.has_value());

    const Body cylinder = only_body(
        body_of("name = \"vessel\"\nshape = \"cylinder\"\ncenter_mm = [0, 0]\ndepth_mm = 4\n"
                "radius_mm = 1.5\nlength_mm = 40\nazimuth_deg = 30\nedge_mm = 0.5\n"
                "viscosity_Pa_s = 0\ndensity_kg_m3 = 1060\nc_p_m_s = 1550\n"));
    CHECK(cylinder.name == "vessel");
    CHECK(std::get<Cylinder>(cylinder.shape) ==
          Cylinder{.radius_m = 0.0015, .length_m = 0.04, .azimuth_deg = 30.0});
    CHECK(cylinder.centre_m == Vec3{0.0, 0.0, 0.004});
    CHECK(cylinder.edge_m == 0.0005);
    CHECK(cylinder.viscosity_Pa_s == 0.0);
    CHECK(cylinder.density_kg_m3 == 1060.0);

    const Body box = only_body(body_of(
        "shape = \"box\"\ncenter_mm = [0, 0, 4]\nsize_mm = [6, 5, 4]\ndensity_kg_m3 = 1\n"));
    CHECK(std::get<Box>(box.shape) == Box{{0.006, 0.005, 0.004}});
}

TEST_CASE("a cylinder lies along an axis by name", "[config][body]") {
    const auto cylinder = [](const std::string& line) {
        return std::get<Cylinder>(only_body(body_of(upright + line)).shape);
    };
    CHECK(cylinder("axis = \"x\"") == Cylinder{.radius_m = 0.003});
    CHECK(cylinder("axis = \"y\"") == Cylinder{.radius_m = 0.003, .azimuth_deg = 90.0});
    CHECK(cylinder("azimuth_deg = 90") == cylinder("axis = \"y\""));
    CHECK(cylinder("axis = \"z\"") == Cylinder{.radius_m = 0.003, .axis = CylinderAxis::vertical});
}

TEST_CASE("an infinite vertical cylinder requires no depth", "[config][body]") {
    CHECK(only_body(body_of("shape = \"cylinder\"\ncenter_mm = [1, 2]\nradius_mm = 3\naxis = "
                            "\"z\"\nc_s_m_s = 9\n"))
              .centre_m == Vec3{0.001, 0.002, 0.0});
}

TEST_CASE("a body's preset fills in what is not given", "[config][body]") {
    const auto bone = [](const std::string& more) {
        return only_body(body_of("preset = \"cortical-bone\"\nshape = \"cylinder\"\naxis = \"x\"\n"
                                 "center_mm = [0, 0, 10]\nradius_mm = 4\n" +
                                 more));
    };
    // The source's mean moduli, to the figures they have.
    CHECK(1900.0 * std::pow(bone("").c_p_m_s.value(), 2) == Approx(23.5e9).epsilon(1e-6));
    CHECK(1900.0 * std::pow(bone("").c_s_m_s.value(), 2) == Approx(4.98e9).epsilon(1e-6));
    CHECK(bone("").viscosity_Pa_s == 0.0);
    CHECK(bone("density_kg_m3 = 2000\n").density_kg_m3 == 2000.0);
}

TEST_CASE("an error in a body is reported with its location", "[config][body]") {
    const auto [old, by, diagnostic] = GENERATE(table<std::string, std::string, std::string>({
        {"[1.0, 2.0, 10.0]", "[1.0, 2.0]", "28:1 depth_mm is missing"},
        {"[1.0, 2.0, 10.0]", "[1.0]", "30:13 center_mm must be [x, y, z], or [x, y]"},
        {"[1.0, 2.0, 10.0]", "[1.0, 2.0, 10.0]\ndepth_mm = 10",
         "31:12 depth_mm and the z of center_mm = [x, y, z] are both given; remove one of them"},
        {"c_s_m_s = 9.0", "edge_mm = 1.0", "29:9 shape has the same material as its"},
        {"c_s_m_s = 9.0", "c_s_m_s = 1400.0", "32:11 c_s_m_s gives c_p = 1500 and c_s = 1400 m/s"},
        {"c_s_m_s = 9.0", "c_s_m_s = 9.0\nc_p_m_s = 10.0", "33:11 c_p_m_s gives c_p = 10 and c_s"},
        {"c_s_m_s = 9.0", "c_s_m_s = 9.0\nedge_mm = 6.5", "33:11 edge_mm must not exceed 6"},
        {"10.0]", "26.0]", "30:13 center_mm places the body below the rigid base at 20 mm"},
        {"10.0]", "-6.0]", "30:13 center_mm places the body above the surface: z is counted"},
        {"c_s_m_s = 9.0", "preset = \"bone\"\nc_s_m_s = 9.0",
         "32:10 preset must be \"cortical-bone\", but is \"bone\""},
    }));
    CAPTURE(old, by);
    check_only(diagnostics_of(replaced(job_with(ball), old, by)),
               error_at(diagnostic, "medium.body[1]."));
}

TEST_CASE("a body has any orientation", "[config][body]") {
    const Body ellipsoid =
        only_body(job_with(std::string(ball) + "azimuth_deg = 30\nroll_deg = -20.1\n"));
    CHECK(std::get<Ellipsoid>(ellipsoid.shape) ==
          Ellipsoid{{0.003, 0.004, 0.005}, {.azimuth_deg = 30.0, .roll_deg = -20.1}});
    const Body box = only_body(
        body_of("shape = \"box\"\ncenter_mm = [0, 0, 9]\nsize_mm = [6, 5, 4]\nc_s_m_s = 9\n"
                "inclination_deg = -90\n"));
    CHECK(std::get<Box>(box.shape) == Box{{0.006, 0.005, 0.004}, {.inclination_deg = -90.0}});
    const Body cylinder = only_body(
        body_of("shape = \"cylinder\"\ncenter_mm = [0, 0, 9]\nradius_mm = 2\nlength_mm = 9\n"
                "c_s_m_s = 9\nazimuth_deg = 30\ninclination_deg = 20\n"));
    CHECK(std::get<Cylinder>(cylinder.shape) ==
          Cylinder{
              .radius_m = 0.002, .length_m = 0.009, .azimuth_deg = 30.0, .inclination_deg = 20.0});
}

TEST_CASE("a cylinder has one direction, and a length if it is inclined", "[config][body]") {
    const auto [more, said] = GENERATE(table<std::string, std::string>({
        {"", "28:1 axis is missing"},
        {"axis = \"x\"\nazimuth_deg = 0", "34:15 azimuth_deg and axis are both given; remove"},
        {"length_mm = 9\ninclination_deg = 20", "28:1 azimuth_deg is missing"},
        {"length_mm = 9\naxis = \"x\"\ninclination_deg = 20",
         "35:19 inclination_deg and axis are both given; give azimuth_deg instead of axis"},
        {"azimuth_deg = 0\ninclination_deg = 20", "34:19 inclination_deg requires length_mm"},
        {"length_mm = 9\nazimuth_deg = 0\nroll_deg = 1", "35:1 roll_deg is unknown"},
    }));
    check_only(diagnostics_of(body_of(upright + more + "\n")), error_at(said, "medium.body[1]."));
}

TEST_CASE("all errors in all bodies are reported at once", "[config][body]") {
    CHECK(diagnostics_of(job_with("[[medium.body]]\nshape = \"box\"\nsize_mm = 3\n[[medium.body]]\n"
                                  "shape = \"cylinder\"\nradius_mm = -1\nhight_mm = 2\n"))
              .size() == 8);
}

TEST_CASE("the numbers of a body can be swept", "[config][body]") {
    const std::string job = body_of("shape = \"cylinder\"\ncenter_mm = [0, 0]\nradius_mm = 3\n"
                                    "axis = \"x\"\npreset = \"cortical-bone\"\ndepth_mm = 9\n"
                                    "[sweep]\n");
    const auto bodies = [&](const std::string& axis) {
        std::vector<Body> found;
        for (const PlannedCase& c : config::read_job(job + axis, "job.toml").plan.cases)
            found.push_back(c.physics.scene.medium.bodies.at(0));
        return found;
    };
    CHECK(bodies("\"medium.body[1].depth_mm\" = [8, 9]\n").at(0).centre_m.z == 0.008);
    CHECK(bodies("\"medium.body[1].depth_mm\" = [8, 9]\n").at(1).centre_m.z == 0.009);
    CHECK(bodies("\"medium.body[1].c_s_m_s\" = [8, 900]\n").at(1).c_s_m_s == 900.0);
    CHECK(bodies("\"medium.body[1].center_mm\" = [[0, 0], [1, 0]]\n").at(1).centre_m.x == 0.001);
    CHECK(any_contains(diagnostics_of(job + "\"medium.body[2].depth_mm\" = [8, 9]\n"),
                       "the list has 1 entries, counted from 1"));
}

TEST_CASE("the layered engine rejects a body with its location", "[config][body]") {
    const Texts texts = diagnostics_of(plain_and(ball));
    REQUIRE(texts.size() == 1);
    CHECK(texts[0].starts_with("job.toml:"));
    CHECK(any_contains(texts, "error: medium.body: the engine \"layered\""));
    CHECK(any_contains(texts, "solver.engine = \"spectral\""));
}

TEST_CASE("a map is provided by the loader and is part of the case", "[config][body]") {
    const std::string job =
        replaced(job_with(""), "[[medium.layer]]", "map = \"a.h5\"\n[[medium.layer]]");
    std::vector<std::string> asked;
    const config::Job read = config::read_job(job, "job.toml", {}, [&](const std::string& file) {
        asked.push_back(file);
        return small_map(7.0);
    });
    CHECK(asked == std::vector<std::string>{"a.h5"});
    CHECK(read.plan.cases.at(0).physics.scene.medium.map->c_s_m_s == std::vector{7.0});
    CHECK(read.plan.cases.at(0).id != case_id(only_case(job_with(""))));
    CHECK(diagnostics_of(job) == Texts{"job.toml:7:7: error: medium.map names a file, but this job "
                                       "is read without access to files"});
}

TEST_CASE("an error in a map is reported together with other errors", "[config][body]") {
    const std::string job =
        replaced(job_with(""), "[[medium.layer]]", "map = \"a.h5\"\n[[medium.layer]]");
    const config::MapLoader broken = [](const std::string&) -> std::shared_ptr<const MaterialMap> {
        throw UsageError("a.h5: it is torn");
    };
    CHECK(diagnostics_of(job, {}, broken) ==
          Texts{error_at("7:7 medium.map cannot be used: a.h5: it is torn")});
    CHECK(any_contains(diagnostics_of(replaced(job, "peak_Pa = 100.0", "peak_Pa = 0"), {}, broken),
                       "peak_Pa"));
    CHECK(diagnostics_of(job, {}, [](const std::string&) { return small_map(1400.0); }) ==
          Texts{error_at("7:7 medium.map gives c_p = 1500 and c_s = 1400 m/s somewhere in layer "
                         "\"tissue\": c_p must be above 1616.58, 1.1547 times c_s, for a positive "
                         "bulk modulus")});
}

} // namespace test_body_reader
