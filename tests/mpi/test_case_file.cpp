// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "storage/case_file/case_file_reader.hpp"
#include "storage/case_file/case_file_writer.hpp"
#include "storage/files.hpp"
#include "storage/hdf5/h5.hpp"
#include "support/shared_folder.hpp"

#include <catch2/catch.hpp>
#include <filesystem>

namespace test_case_file {

using namespace shearwake;
using test::SharedFolder;

const std::vector<Attribute> complete = {{"title", std::string("a title")},
                                         {"case_id", std::string("00ff")},
                                         {"ranks", 2L},
                                         {"status", std::string("complete")}};

TEST_CASE("writes the slabs of all ranks as one surface", "[mpi]") {
    const Comm world = Comm::world();
    const SharedFolder folder(world);
    const Domain domain{4, 6, 1e-3, 0.0}; // the last of 5 ranks has no row
    const std::ptrdiff_t per_rank = (domain.nx + world.size() - 1) / world.size();
    const std::ptrdiff_t start = std::min(domain.nx, per_rank * world.rank());
    const std::ptrdiff_t rows = std::min(domain.nx, start + per_rank) - start;
    const auto value = [](std::size_t t, std::ptrdiff_t i, std::ptrdiff_t j) {
        return 1000.0 * static_cast<double>(t) + static_cast<double>(10 * i + j);
    };
    {
        storage::CaseFileWriter writer(folder.file("00ff.h5"), world, {domain, {0.1, 0.2}, {0.0}});
        for (std::size_t t = 0; t < 2; ++t) {
            std::vector<double> slab(static_cast<std::size_t>(rows * 8), -1.0); // padded rows
            for (std::ptrdiff_t i = 0; i < rows; ++i)
                for (std::ptrdiff_t j = 0; j < 6; ++j)
                    slab[static_cast<std::size_t>(i * 8 + j)] = value(t, start + i, j);
            writer.write_surface(t, 0, View2<const double>(slab.data(), rows, 6, 8), start);
        }
        writer.commit({{"", {{"eta_at_1", {}, {0.25}, "1", "eta", ""}}}}, complete);
    }
    bool fine = true;
    on_root(world, [&] {
        fine = storage::is_complete(folder.file("00ff.h5"), "00ff") &&
               !storage::is_complete(folder.file("00ff.h5"), "0") &&
               !std::filesystem::exists(storage::part_path(folder.file("00ff.h5")));
        const storage::CaseSummary summary = storage::read_case_summary(folder.file("00ff.h5"));
        fine = fine && summary.scalars.at(0).values.at(0) == 0.25 &&
               summary.numbers.at("ranks") == 2.0;
        const h5::Id file = h5::open_file(folder.file("00ff.h5"), h5::Access::read);
        const auto u = h5::read_all(h5::open_dataset(file.raw(), "surface/u_z"));
        for (std::size_t t = 0; t < 2; ++t)
            for (std::ptrdiff_t i = 0; i < 4; ++i)
                for (std::ptrdiff_t j = 0; j < 6; ++j)
                    fine =
                        fine && u[t * 24 + static_cast<std::size_t>(6 * i + j)] == value(t, i, j);
    });
    CHECK(world.max(fine ? 0 : 1) == 0);
}

TEST_CASE("leaves no file behind without commit", "[mpi]") {
    const Comm world = Comm::world();
    const SharedFolder folder(world);
    { const storage::CaseFileWriter writer(folder.file("a.h5"), world, {}); }
    world.barrier();
    CHECK_FALSE(std::filesystem::exists(folder.file("a.h5")));
    CHECK_FALSE(std::filesystem::exists(storage::part_path(folder.file("a.h5"))));
    // If no file can be created, all ranks throw together.
    CHECK_THROWS_AS(storage::CaseFileWriter(folder.file("none/a.h5"), world, {}), Error);
}

TEST_CASE("reports a truncated file as damaged", "[mpi]") {
    const Comm world = Comm::world();
    const SharedFolder folder(world);
    const auto path = folder.file("00ff.h5");
    storage::CaseFileWriter(path, world, {})
        .commit({{"", {{"t", {"t"}, std::vector<double>(1000, 1.0), "s", "time", ""}}}}, complete);
    int fine = 0;
    on_root(world, [&] {
        std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
        fine = storage::is_complete(path, "00ff") ? 1 : 0;
        CHECK_THROWS_AS(storage::read_case_summary(path), Error);
    });
    CHECK(world.max(fine) == 0);
}

} // namespace test_case_file
