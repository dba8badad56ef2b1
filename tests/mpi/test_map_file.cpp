// SPDX-License-Identifier: BSD-3-Clause
#include "storage/input/input_files.hpp"

#include "base/error.hpp"
#include "storage/hdf5/h5.hpp"
#include "support/shared_folder.hpp"

#include <catch2/catch.hpp>

namespace test_map_file {

using namespace shearwake;

/// More points than one message of the broadcast contains.
constexpr hsize_t nx = 2100, ny = 2001, nz = 1;

static void write_map(const std::filesystem::path& path) {
    const h5::Id file = h5::open_file(path, h5::Access::create);
    const auto put = [&](const char* name, std::vector<hsize_t> shape, auto value) {
        hsize_t count = 1;
        for (const hsize_t extent : shape)
            count *= extent;
        std::vector<double> values;
        for (hsize_t i = 0; i < count; ++i)
            values.push_back(value(static_cast<double>(i)));
        h5::write_all(h5::create_dataset(file.raw(), name, shape), values);
    };
    put("x_m", {nx}, [](double i) { return 1e-4 * i; });
    put("y_m", {ny}, [](double i) { return 1e-4 * i - 0.05; });
    put("z_m", {nz}, [](double) { return 0.0; });
    put("c_s_m_s", {nx, ny, nz}, [](double i) { return 1.0 + 1e-6 * i; });
}

TEST_CASE("distributes the same map to every rank", "[mpi]") {
    const Comm world = Comm::world();
    const test::SharedFolder folder(world);
    on_root(world, [&] { write_map(folder.file("map.h5")); });
    const MaterialMap map = storage::read_map_file(folder.file("map.h5"), world);
    // The hash is computed again from the received data and compared with rank 0's.
    const double differs = hash_of(map) == world.broadcast(map.content_hash) ? 0.0 : 1.0;
    CHECK(world.max(differs) == 0.0);
    const double last = map.c_s_m_s.empty() ? 0.0 : map.c_s_m_s.back();
    CHECK(world.max(last) == 1.0 + 1e-6 * static_cast<double>(nx * ny * nz - 1));
    CHECK(world.max(-last) == -last);
}

TEST_CASE("reports a missing map on all ranks", "[mpi]") {
    const Comm world = Comm::world();
    std::string said;
    try {
        storage::read_map_file("/nowhere/map.h5", world);
    } catch (const UsageError& error) {
        said = error.what();
    }
    const bool as_on_root = said == world.broadcast(said);
    CHECK(world.max(as_on_root ? 0 : 1) == 0);
    CHECK(said == "/nowhere/map.h5 does not exist");
}

} // namespace test_map_file
