// SPDX-License-Identifier: BSD-3-Clause
#include "storage/input/input_files.hpp"

#include "base/error.hpp"
#include "storage/files.hpp"
#include "storage/hdf5/h5.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <fmt/format.h>

namespace test_motion_file {

using namespace shearwake;

static void write(const h5::Id& parent, const std::string& name, std::vector<hsize_t> shape,
                  const std::vector<double>& values) {
    h5::write_all(h5::create_dataset(parent.raw(), name, shape), values);
}

TEST_CASE("a motion is read from CSV in its units", "[motion]") {
    const PointMotion motion = storage::motion_of_csv("# two points\n"
                                                      "t_ms,u_um,u_mm\n"
                                                      "x_mm,0,5\ny_cm,1,0\n"
                                                      "0,0,0\n0.2,2,3\n0.4,-4,nan\n");
    CHECK(motion.rate_Hz == 5000.0);
    CHECK(motion.at_m == std::vector<Vec2>{{0.0, 0.01}, {0.005, 0.0}});
    REQUIRE(motion.u_m.size() == 2);
    CHECK(motion.u_m[0] == std::vector{0.0, 2 * 1e-6, -4 * 1e-6});
    CHECK(motion.u_m[1][1] == 3 * 1e-3);
    CHECK(std::isnan(motion.u_m[1][2])); // told later, with its place
}

TEST_CASE("units and order of indices that an HDF5 file states are used", "[motion]") {
    const test::TemporaryFolder folder;
    const auto motion_in = [&](const std::string& unit, bool by_matlab) {
        const auto path = folder / "m.h5";
        {
            const h5::Id file = h5::open_file(path, h5::Access::create);
            write(file, "u_z", {2, 2}, {0.0, 1.0, 2.0, 3.0});
            write(file, "time", {2}, {0.0, 2.0});
            write(file, "x", {2}, {0.0, 5.0});
            write(file, "y", {2}, {0.0, 0.0});
            const h5::Id u = h5::open_dataset(file.raw(), "u_z"),
                         t = h5::open_dataset(file.raw(), "time");
            h5::put_attribute(u.raw(), "units", unit);
            h5::put_attribute(t.raw(), "units", std::string("ms"));
            if (by_matlab) h5::put_attribute(u.raw(), "MATLAB_class", std::string("double"));
        }
        return storage::read_motion(path, "");
    };
    const PointMotion points = motion_in("um", false), columns = motion_in("\u00b5m", true);
    CHECK(points.rate_Hz == Approx(500.0));
    CHECK(points.u_m ==
          std::vector<std::vector<double>>{{0.0, 1.0 * 1e-6}, {2.0 * 1e-6, 3.0 * 1e-6}});
    CHECK(columns.u_m ==
          std::vector<std::vector<double>>{{0.0, 2.0 * 1e-6}, {1.0 * 1e-6, 3.0 * 1e-6}});
    CHECK_THROWS_WITH(motion_in("Pa", false),
                      Catch::Contains("has the units Pa, but must be a length"));
}

TEST_CASE("an error in the CSV file of a motion is reported with its line", "[motion]") {
    CHECK_THROWS_WITH(storage::motion_of_csv(""), Catch::Contains("empty"));
    CHECK_THROWS_WITH(storage::motion_of_csv("t,u_um\n"),
                      Catch::Contains("line 1") && Catch::Contains("unit of time"));
    CHECK_THROWS_WITH(storage::motion_of_csv("t_ms,u_Pa\n"), Catch::Contains("unit of length"));
    CHECK_THROWS_WITH(storage::motion_of_csv("t_ms,u_um\n0,0\n1,x\n"),
                      Catch::Contains("line 3: \"x\" is not a number"));
    CHECK_THROWS_WITH(storage::motion_of_csv("t_ms,u_um\n0,0\n1\n"),
                      Catch::Contains("line 3: it has 1"));
    CHECK_THROWS_WITH(storage::motion_of_csv("t_ms,u_um,u_um\n0,0,0\n1,1,1\n"),
                      Catch::Contains("not their positions"));
    CHECK_THROWS_WITH(storage::motion_of_csv("t_ms,u_um\n0,0\n1,0\n3,0\n"),
                      Catch::Contains("must be uniformly spaced: number 1"));
    CHECK_THROWS_WITH(storage::motion_of_csv("t_ms,u_um\n1,0\n0,0\n"),
                      Catch::Contains("must be in ascending order"));
    CHECK_THROWS_WITH(storage::motion_of_csv("t_ms,u_um\n0,0\n"), Catch::Contains("2 times"));
}

TEST_CASE("times with few digits have the rate that they are rounded from", "[motion]") {
    // 3 kHz in ms with two decimals, as 5 digits allow after 100 ms.
    std::string text = "t_ms,u_um\n";
    for (int k = 0; k <= 600; ++k)
        text += fmt::format("{:.2f},0\n", k / 3.0);
    CHECK(storage::motion_of_csv(text).rate_Hz == 3000.0);
    CHECK_THROWS_WITH(storage::motion_of_csv(text + "200.50,0\n"),
                      Catch::Contains("must be uniformly spaced"));
}

TEST_CASE("the stress at receptors is read from CSV in its units, without positions", "[motion]") {
    const PointStress stress = storage::stress_of_csv("t_ms,p_Pa,p_kPa\n0,0,0\n0.5,2,3\n");
    CHECK(stress.rate_Hz == 2000.0);
    CHECK(stress.compression_Pa == std::vector<std::vector<double>>{{0.0, 2.0}, {0.0, 3e3}});
    CHECK_THROWS_WITH(storage::stress_of_csv("t_ms,u_um\n0,0\n1,0\n"),
                      Catch::Contains("unit of pressure") && Catch::Contains("t_ms,p_Pa"));
    CHECK_THROWS_WITH(storage::stress_of_csv("t_ms,p_Pa\nx_mm,0\n0,0\n1,0\n"),
                      Catch::Contains("given by [afferents]"));
}

TEST_CASE("the stress at receptors is read from HDF5", "[motion]") {
    const test::TemporaryFolder folder;
    const auto path = folder / "stress.h5";
    {
        const h5::Id file = h5::open_file(path, h5::Access::create);
        const h5::Id group = h5::create_group(file.raw(), "skin");
        write(group, "compression_Pa", {2, 3}, {1, 2, 3, 4, 5, 6});
        h5::put_attribute(group.raw(), "fs_hz", 1000.0);
    }
    const PointStress stress = storage::read_stress(path, "skin");
    CHECK(stress.rate_Hz == 1000.0);
    CHECK(stress.compression_Pa == std::vector<std::vector<double>>{{1, 2, 3}, {4, 5, 6}});
    CHECK_THROWS_WITH(storage::read_stress(path, ""),
                      Catch::Contains("does not contain compression_Pa"));
}

TEST_CASE("a motion is read from the traces of a case file, preceded by rest", "[motion]") {
    const test::TemporaryFolder folder;
    const auto path = folder / "case.h5";
    {
        const h5::Id file = h5::open_file(path, h5::Access::create);
        const h5::Id group = h5::create_group(file.raw(), "traces");
        write(group, "u_z", {2, 3}, {1, 2, 3, 4, 5, 6});
        write(group, "time", {3}, {1e-3, 2e-3, 3e-3});
        write(group, "x", {2}, {0.0, 0.01});
        write(group, "y", {2}, {0.0, 0.02});
    }
    const PointMotion motion = storage::read_motion(path, "");
    CHECK(motion.rate_Hz == 1000.0);
    CHECK(motion.at_m == std::vector<Vec2>{{}, {0.01, 0.02}});
    CHECK(motion.u_m == std::vector<std::vector<double>>{{0, 1, 2, 3}, {0, 4, 5, 6}});
    CHECK_THROWS_WITH(storage::read_motion(path, "pins"),
                      Catch::Contains("the group pins contains neither"));
}

TEST_CASE("times in single precision and names in capitals are read", "[motion]") {
    const test::TemporaryFolder folder;
    std::vector<double> times_ms;
    for (int n = 1; n <= 51200; ++n)
        times_ms.push_back(static_cast<float>(n * 1e3 / 51200.0));
    {
        const h5::Id file = h5::open_file(folder / "case.h5", h5::Access::create);
        write(file, "u_z", {1, 51200}, std::vector<double>(51200, 1e-6));
        write(file, "time", {51200}, times_ms);
        write(file, "x", {1}, {0.0});
        write(file, "y", {1}, {0.0});
        h5::put_attribute(h5::open_dataset(file.raw(), "time").raw(), "units", std::string("ms"));
    }
    CHECK(storage::read_motion(folder / "case.h5", "").rate_Hz == 51200.0);
    storage::write_file(folder / "MOTION.CSV", "t_ms,u_um\n0,0\n1,1\n2,0\n");
    CHECK(storage::read_motion(folder / "MOTION.CSV", "").rate_Hz == 1000.0);
}

TEST_CASE("a motion is read from traces in millimetres with their rate and radius", "[motion]") {
    const test::TemporaryFolder folder;
    const auto path = folder / "traces.h5";
    {
        const h5::Id file = h5::open_file(path, h5::Access::create);
        const h5::Id outer = h5::create_group(file.raw(), "am200");
        const h5::Id group = h5::create_group(outer.raw(), "square");
        write(group, "trace_mm", {1, 2}, {1, 2});
        write(group, "pin_xy_mm", {1, 2}, {126, 10});
        h5::put_attribute(group.raw(), "fs_hz", 200e3);
        h5::put_attribute(group.raw(), "pin_radius_mm", 1.0);
    }
    const PointMotion motion = storage::read_motion(path, "am200/square");
    CHECK(motion.rate_Hz == 200e3);
    CHECK(motion.radius_m == 1e-3);
    CHECK(motion.at_m == std::vector<Vec2>{{0.126, 0.01}});
    CHECK(motion.u_m == std::vector<std::vector<double>>{{1e-3, 2e-3}});
    CHECK_THROWS_AS(storage::read_motion(path, ""), UsageError);
    CHECK_THROWS_WITH(storage::read_motion(folder / "none.h5", ""),
                      Catch::Contains("none.h5 does not exist"));
}

} // namespace test_motion_file
