// SPDX-License-Identifier: BSD-3-Clause
#include "storage/input/input_files.hpp"

#include "base/error.hpp"
#include "storage/files.hpp"
#include "storage/hdf5/h5.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>

namespace test_map_file {

using namespace shearwake;

using Values = std::vector<double>;

/// A dataset on its way into a file.
struct Dataset {
    std::vector<hsize_t> shape;
    Values values;
};
using Datasets = std::map<std::string, Dataset>;

static void write(const std::filesystem::path& path, const Datasets& datasets) {
    const h5::Id file = h5::open_file(path, h5::Access::create);
    for (const auto& [name, dataset] : datasets)
        h5::write_all(h5::create_dataset(file.raw(), name, dataset.shape), dataset.values);
}

/// 2 x 3 x 2 points.
static Datasets good() {
    return {{"x_m", {{2}, {-1e-3, 1e-3}}},
            {"y_m", {{3}, {-2e-3, 0.0, 2e-3}}},
            {"z_m", {{2}, {1e-3, 4e-3}}},
            {"c_s_m_s", {{2, 3, 2}, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}}},
            {"viscosity_Pa_s", {{2, 3, 2}, Values(12, 0.0)}}};
}

/// The error that the reader reports for a file; empty if the file is valid.
static std::string complaint(const std::filesystem::path& path) {
    try {
        storage::read_map_file(path);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

static std::string complaint(const Datasets& datasets) {
    const test::TemporaryFolder folder;
    write(folder / "map.h5", datasets);
    return complaint(folder / "map.h5");
}

static Datasets with(const std::string& name, Dataset dataset) {
    Datasets changed = good();
    changed[name] = std::move(dataset);
    return changed;
}

static bool has(const std::string& text, std::string_view part) {
    INFO(text);
    return text.find(part) != std::string::npos;
}

/// A file of one dataset of any type and layout, without values.
static void write_raw(const std::filesystem::path& path, const std::string& name, hid_t type,
                      const std::vector<hsize_t>& shape) {
    write(path, {});
    const h5::Id file = h5::open_file(path, h5::Access::read_write);
    const h5::Id space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                       H5Sclose, "make a space");
    const h5::Id chunks(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make a list");
    h5::check(H5Pset_chunk(chunks.raw(), static_cast<int>(shape.size()),
                           std::vector<hsize_t>(shape.size(), 1).data()),
              "chunk");
    const h5::Id dataset(H5Dcreate2(file.raw(), name.c_str(), type, space.raw(), H5P_DEFAULT,
                                    chunks.raw(), H5P_DEFAULT),
                         H5Dclose, "make a dataset");
    for (const char* axis : {"x_m", "y_m", "z_m"}) {
        if (name == axis) continue;
        h5::write_all(h5::create_dataset(file.raw(), axis, std::vector<hsize_t>{1}), Values{0.0});
    }
}

TEST_CASE("a map is read as it was written", "[map_file]") {
    const test::TemporaryFolder folder;
    write(folder / "map.h5", good());
    const MaterialMap map = storage::read_map_file(folder / "map.h5");
    CHECK(map.counts == std::array<std::ptrdiff_t, 3>{2, 3, 2});
    CHECK(map.origin_m == Vec3{-1e-3, -2e-3, 1e-3});
    CHECK(map.spacing_m == Vec3{2e-3, 2e-3, 3e-3});
    CHECK(map.c_s_m_s == good()["c_s_m_s"].values);
    CHECK(map.viscosity_Pa_s == Values(12, 0.0));
    CHECK(map.c_p_m_s.empty());
    CHECK(map.density_kg_m3.empty());
    CHECK(map.content_hash == hash_of(map));
    // [1][0][1] of the file is the point at x = 1, y = -2, z = 4 mm.
    CHECK(sample(map, {1e-3, -2e-3, 4e-3}).c_s_m_s.value() == Approx(8.0).epsilon(1e-12));
}

TEST_CASE("the order of indices is that which a file states", "[map_file]") {
    // 2 x 3 x 2 points with x and z alike: the value is 100 x + 10 y + z.
    const Values ordered = {111, 112, 121, 122, 131, 132, 211, 212, 221, 222, 231, 232},
                 turned = {111, 211, 121, 221, 131, 231, 112, 212, 122, 222, 132, 232};
    const test::TemporaryFolder folder;
    const auto path = folder / "map.h5";
    const auto map_of = [&](const Values& values,
                            const std::function<void(const h5::Id&)>& change) {
        Datasets datasets = with("c_s_m_s", {{2, 3, 2}, values});
        datasets.erase("viscosity_Pa_s");
        write(path, datasets);
        const h5::Id file = h5::open_file(path, h5::Access::read_write);
        change(file);
    };
    const auto read = [&] { return storage::read_map_file(path); };
    const auto scales = [](const h5::Id& file, std::array<const char*, 3> names) {
        for (unsigned n = 0; n < 3; ++n) {
            const h5::Scale scale(h5::open_dataset(file.raw(), names[n]), names[n]);
            h5::attach_scale(h5::open_dataset(file.raw(), "c_s_m_s"), scale.dataset(), n);
        }
    };
    map_of(ordered, [](const h5::Id&) {});
    CHECK(read().c_s_m_s == ordered);
    CHECK(has(read().contents, "the order (x, y, z) of its indices is assumed"));
    map_of(turned, [](const h5::Id& file) {
        h5::put_attribute(h5::open_dataset(file.raw(), "c_s_m_s").raw(), "MATLAB_class",
                          std::string("double"));
        // A row of MATLAB.
        H5Ldelete(file.raw(), "z_m", H5P_DEFAULT);
        const h5::Id row = h5::create_dataset(file.raw(), "z_m", std::vector<hsize_t>{2, 1});
        h5::write_all(row, Values{1e-3, 4e-3});
        h5::put_attribute(row.raw(), "MATLAB_class", std::string("double"));
    });
    CHECK(read().c_s_m_s == ordered);
    CHECK_FALSE(has(read().contents, "assumed"));
    map_of(turned, [&](const h5::Id& file) { scales(file, {"z_m", "y_m", "x_m"}); });
    CHECK(read().c_s_m_s == ordered);
    CHECK_FALSE(has(read().contents, "assumed"));
    map_of(ordered, [&](const h5::Id& file) { scales(file, {"x_m", "y_m", "z_m"}); });
    CHECK(read().c_s_m_s == ordered);
    CHECK(has(read().contents, "2 x 3 x 2 points, x -1 to 1 mm, y -2 to 2 mm, z 1 to 4 mm; c_s_m_s "
                               "111 to 232, mean by depth: 171 at 1 mm, 172 at 4 mm"));
}

TEST_CASE("a map whose only possible order is (z, y, x) is read in it", "[map_file]") {
    Datasets reversed = good();
    reversed["z_m"] = {{3}, {1e-3, 4e-3, 7e-3}};
    reversed["c_s_m_s"] = {{3, 3, 2}, Values(18, 5.0)};
    reversed["c_s_m_s"].values[1] = 7.0; // z 1, x 2
    reversed.erase("viscosity_Pa_s");
    const test::TemporaryFolder folder;
    write(folder / "map.h5", reversed);
    const MaterialMap map = storage::read_map_file(folder / "map.h5");
    CHECK(map.c_s_m_s[9] == 7.0);
    CHECK(has(map.contents, "have the order (z, y, x), as h5write of MATLAB stores"));
}

TEST_CASE("a unit that a map states is used, or rejected if it cannot be read", "[map_file]") {
    const auto read = [](const std::string& name, const std::string& unit) {
        const test::TemporaryFolder folder;
        Datasets datasets = good();
        datasets["x_m"].values = {-1.0, 1.0};
        write(folder / "map.h5", datasets);
        {
            const h5::Id file = h5::open_file(folder / "map.h5", h5::Access::read_write);
            h5::put_attribute(h5::open_dataset(file.raw(), name).raw(), "units", unit);
        }
        return storage::read_map_file(folder / "map.h5");
    };
    CHECK(read("x_m", "mm").origin_m.x == Approx(-1e-3));
    for (const char* unit : {"m", "metres", "1", "", "SI"})
        CHECK(read("x_m", unit).origin_m.x == -1.0);
    for (const char* unit : {"m s-1", "m/s", "m s^-1", "m*s-1"})
        CHECK(read("c_s_m_s", unit).c_s_m_s == good()["c_s_m_s"].values);
    CHECK_THROWS_WITH(read("x_m", "inch"),
                      Catch::Contains("has the units inch, which cannot be read; convert it to m"));
    CHECK_THROWS_WITH(read("c_s_m_s", "ft/s"), Catch::Contains("which cannot be read"));
}

TEST_CASE("the content of the file matters, not its name", "[map_file]") {
    const test::TemporaryFolder folder;
    write(folder / "a.h5", good());
    write(folder / "b.h5", good());
    write(folder / "c.h5", with("c_s_m_s", {{2, 3, 2}, Values(12, 3.0)}));
    CHECK(storage::read_map_file(folder / "a.h5") == storage::read_map_file(folder / "b.h5"));
    CHECK_FALSE(storage::read_map_file(folder / "a.h5") == storage::read_map_file(folder / "c.h5"));
}

TEST_CASE("a file without order of creation is read", "[map_file]") {
    const test::TemporaryFolder folder;
    const std::filesystem::path path = folder / "map.h5";
    {
        const h5::Id file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
                          H5Fclose, "create");
        for (const auto& [name, dataset] : good())
            h5::write_all(h5::create_dataset(file.raw(), name, dataset.shape), dataset.values);
    }
    CHECK(storage::read_map_file(path).c_s_m_s == good()["c_s_m_s"].values);
}

TEST_CASE("coordinates in single precision are accepted", "[map_file]") {
    const test::TemporaryFolder folder;
    write_raw(folder / "map.h5", "density_kg_m3", H5T_NATIVE_FLOAT, {1, 1, 1});
    {
        const h5::Id file = h5::open_file(folder / "map.h5", h5::Access::read_write);
        h5::write_all(h5::open_dataset(file.raw(), "density_kg_m3"), Values{1000.0});
    }
    CHECK(storage::read_map_file(folder / "map.h5").density_kg_m3 == Values{1000.0});
    CHECK(storage::read_map_file(folder / "map.h5").spacing_m == Vec3{});
    // Coordinates in steps of 0.3 mm, as single precision holds them.
    Values x_m;
    for (int i = 0; i < 200; ++i)
        x_m.push_back(static_cast<double>(static_cast<float>(-0.03 + 0.0003 * i)));
    CHECK(complaint(Datasets{{"x_m", {{200}, x_m}},
                             {"y_m", {{1}, {0.0}}},
                             {"z_m", {{1}, {0.0}}},
                             {"c_s_m_s", {{200, 1, 1}, Values(200, 5.0)}}})
              .empty());
}

TEST_CASE("errors in a map are reported", "[map_file]") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto one_off = [](double value) {
        Values values(12, 5.0);
        values[9] = value;
        return values;
    };
    SECTION("a coordinate list that is missing") {
        Datasets lacking = good();
        lacking.erase("y_m");
        CHECK(has(complaint(lacking), "map.h5: the coordinates y_m are missing"));
    }
    SECTION("no property") {
        Datasets lacking = good();
        lacking.erase("c_s_m_s");
        lacking.erase("viscosity_Pa_s");
        CHECK(has(complaint(lacking), "it contains none of c_s_m_s"));
    }
    SECTION("a mistyped name") {
        CHECK(has(complaint(with("densty_kg_m3", {{2, 3, 2}, Values(12, 1.0)})),
                  "\"densty_kg_m3\" is unknown; did you mean density_kg_m3?"));
    }
    SECTION("another rank") {
        CHECK(has(complaint(with("c_s_m_s", {{12}, Values(12, 5.0)})),
                  "c_s_m_s has the shape (12), but x_m, y_m and z_m have 2, 3 and 2"));
        CHECK(has(complaint(with("z_m", {{1, 2}, {0.0, 1.0}})), "z_m must be a list"));
    }
    SECTION("another order of axes") {
        CHECK(has(complaint(with("c_s_m_s", {{2, 2, 3}, Values(12, 5.0)})), "shape (2, 2, 3)"));
    }
    SECTION("a value that is not finite, with its place") {
        CHECK(has(complaint(with("c_s_m_s", {{2, 3, 2}, one_off(nan)})),
                  "c_s_m_s must be above 0 everywhere, but is nan at [1, 1, 1]"));
    }
    SECTION("a value that is not positive") {
        CHECK(has(complaint(with("c_s_m_s", {{2, 3, 2}, one_off(0.0)})), "is 0 at [1, 1, 1]"));
        CHECK(has(complaint(with("viscosity_Pa_s", {{2, 3, 2}, one_off(-1.0)})),
                  "viscosity_Pa_s must be 0 or more everywhere, but is -1"));
    }
    SECTION("coordinates that are irregular, descend, stand still or are none") {
        CHECK(has(complaint(with("y_m", {{3}, {-2e-3, 1e-4, 2e-3}})),
                  "y_m must be uniformly spaced"));
        CHECK(has(complaint(with("y_m", {{3}, {2e-3, 0.0, -2e-3}})),
                  "y_m must be in ascending order"));
        CHECK(
            has(complaint(with("y_m", {{3}, {0.0, 0.0, 0.0}})), "y_m must be in ascending order"));
        CHECK(has(complaint(with("y_m", {{3}, {-2e-3, nan, 2e-3}})), "not finite"));
        CHECK(has(complaint(with("y_m", {{0}, {}})), "1 to 33554432 coordinates"));
    }
}

TEST_CASE("a malicious file is rejected without a crash", "[map_file]") {
    const test::TemporaryFolder folder;
    const std::filesystem::path path = folder / "map.h5";
    SECTION("not there, a folder, empty, text") {
        CHECK(has(complaint(path), "map.h5 does not exist"));
        CHECK(has(complaint(folder / ""), "is not a regular file"));
        storage::write_file(path, "");
        CHECK(has(complaint(path), "HDF5 cannot open"));
        storage::write_file(path, "x_m,y_m,z_m\n");
        CHECK(has(complaint(path), "HDF5 cannot open"));
    }
    SECTION("torn anywhere") {
        write(path, good());
        const std::string whole = storage::read_file(path);
        const double share = GENERATE(0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99);
        storage::write_file(path, whole.substr(0, static_cast<std::size_t>(
                                                      share * static_cast<double>(whole.size()))));
        CHECK_FALSE(complaint(path).empty());
    }
    SECTION("of a size that no machine holds, in a file of a kilobyte") {
        write_raw(path, "c_s_m_s", H5T_NATIVE_DOUBLE, {1u << 20, 1u << 20, 1u << 20});
        CHECK(has(complaint(path), "shape (1048576, 1048576, 1048576)"));
        write_raw(path, "x_m", H5T_NATIVE_DOUBLE, {std::uint64_t{1} << 60});
        CHECK(has(complaint(path), "x_m must be a list of 1 to 33554432"));
    }
    SECTION("of extents that are possible each and not together") {
        Values many;
        for (int i = 0; i < 10000; ++i)
            many.push_back(1e-3 * i);
        write(path, {{"x_m", {{10000}, many}},
                     {"y_m", {{10000}, many}},
                     {"z_m", {{1}, {0.0}}},
                     {"c_s_m_s", {{1, 1, 1}, {5.0}}}});
        CHECK(has(complaint(path), "it has 1e+08 points"));
    }
    SECTION("of text where numbers belong") {
        write_raw(path, "c_s_m_s", H5T_C_S1, {1, 1, 1});
        CHECK(has(complaint(path), "c_s_m_s does not contain numbers"));
    }
    SECTION("never filled: all values are 0") {
        write_raw(path, "c_s_m_s", H5T_NATIVE_DOUBLE, {1, 1, 1});
        CHECK(has(complaint(path), "is 0 at [0, 0, 0]"));
    }
    SECTION("a link to nowhere") {
        write(path, good());
        {
            const h5::Id file = h5::open_file(path, h5::Access::read_write);
            h5::check(H5Lcreate_soft("/nowhere", file.raw(), "c_p_m_s", H5P_DEFAULT, H5P_DEFAULT),
                      "link");
        }
        CHECK_FALSE(complaint(path).empty());
    }
}

} // namespace test_map_file
