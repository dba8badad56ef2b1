// SPDX-License-Identifier: BSD-3-Clause
#include "storage/checkpoint/checkpoint_file.hpp"

#include "base/error.hpp"
#include "storage/files.hpp"
#include "support/shared_folder.hpp"

#include <catch2/catch.hpp>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <vector>

namespace test_checkpoint_file {

using namespace shearwake;
using test::SharedFolder;

const storage::CheckpointOwner owner{"00ff", "abc"};
constexpr std::ptrdiff_t total = 4, row_length = 3; // uneven on 3 ranks; one of 5 ranks has none

/// Blocks of rows in ascending or descending order of ranks.
enum class Order { forward, reverse };
static DistributedRows rows_of(const Comm& world, Order order) {
    const std::ptrdiff_t place =
        order == Order::forward ? world.rank() : world.size() - 1 - world.rank();
    const std::ptrdiff_t each = (total + world.size() - 1) / world.size();
    const std::ptrdiff_t start = std::min(total, place * each);
    return {total, start, std::min(total, start + each) - start, row_length};
}

static double value_at(std::ptrdiff_t row, std::ptrdiff_t column) {
    if (row == 2 && column == 1) return -0.0;
    if (row == 3 && column == 2) return std::numeric_limits<double>::denorm_min();
    return 1.0 / static_cast<double>(1 + 10 * row + column);
}

static std::vector<double> values_of(const DistributedRows& rows) {
    std::vector<double> values;
    for (std::ptrdiff_t i = rows.start; i < rows.start + rows.count; ++i)
        for (std::ptrdiff_t j = 0; j < rows.row_length; ++j)
            values.push_back(value_at(i, j));
    return values;
}

static void write_state(const std::filesystem::path& path, const Comm& world) {
    storage::CheckpointFileWriter writer(path, world);
    const DistributedRows rows = rows_of(world, Order::forward);
    writer.put("u", rows, values_of(rows).data());
    writer.put("step", 17.0);
    writer.put("t_s", 0.1);
    // A single row on the last rank.
    const bool last = world.rank() == world.size() - 1;
    const double seven = 7.0;
    writer.put("one", {1, 0, last ? 1 : 0, 1}, last ? &seven : nullptr);
    writer.commit(owner, {.sequence = 5, .seconds = 2.5});
}

/// The result of rank 0, on every rank.
static std::string reason(const std::filesystem::path& path, const storage::CheckpointOwner& wanted,
                          const Comm& world, storage::CheckpointFacts& facts) {
    std::string text;
    on_root(world, [&] { text = storage::checkpoint_error(path, wanted, facts); });
    return world.broadcast(text);
}

TEST_CASE("reads a checkpoint back bit by bit for any distribution of rows", "[mpi]") {
    const Comm world = Comm::world();
    const SharedFolder folder(world);
    write_state(folder.file("a.h5"), world);
    storage::CheckpointFacts facts;
    const std::string said = reason(folder.file("a.h5"), owner, world, facts);
    CHECK(said.empty());
    const long sequence = world.broadcast(facts.sequence);
    CHECK(sequence == 5);

    const storage::CheckpointFileReader reader(folder.file("a.h5"), world);
    const Order order = GENERATE(Order::forward, Order::reverse);
    const DistributedRows rows = rows_of(world, order);
    std::vector<double> values(static_cast<std::size_t>(rows.count * row_length));
    reader.get("u", rows, values.data());
    const std::vector<double> expected = values_of(rows);
    bool same = true;
    for (std::size_t i = 0; i < values.size(); ++i)
        same = same && std::signbit(values[i]) == std::signbit(expected[i]) &&
               values[i] == expected[i];
    const int differing = world.max(same ? 0 : 1);
    CHECK(differing == 0);
    // All ranks may request the same row.
    double one = 0.0;
    reader.get("one", {1, 0, 1, 1}, &one);
    const double least = -world.max(-one);
    CHECK(least == 7.0);
    CHECK(reader.get("step") == 17.0);
    CHECK(reader.get("t_s") == 0.1);
}

TEST_CASE("rejects a checkpoint with other rows on all ranks", "[mpi]") {
    const Comm world = Comm::world();
    const SharedFolder folder(world);
    write_state(folder.file("a.h5"), world);
    const storage::CheckpointFileReader reader(folder.file("a.h5"), world);
    double none = 0.0;
    CHECK_THROWS_AS(reader.get("u", {total + 1, 0, 0, row_length}, &none), CaseFailure);
    CHECK_THROWS_AS(reader.get("v", {total, 0, 0, row_length}, &none), CaseFailure);
    CHECK_THROWS_AS(reader.get("v"), CaseFailure);
}

TEST_CASE("leaves no file and keeps the previous checkpoint without commit", "[mpi]") {
    const Comm world = Comm::world();
    const SharedFolder folder(world);
    const auto path = folder.file("a.h5");
    write_state(path, world);
    {
        storage::CheckpointFileWriter writer(path, world);
        writer.put("step", 18.0);
        bool part = true;
        on_root(world, [&] { part = std::filesystem::exists(storage::part_path(path)); });
        CHECK(part);
    }
    world.barrier();
    CHECK_FALSE(std::filesystem::exists(storage::part_path(path)));
    CHECK(storage::CheckpointFileReader(path, world).get("step") == 17.0);
}

TEST_CASE("reports a checkpoint of another case or program and one without its checksum", "[mpi]") {
    const Comm world = Comm::world();
    const SharedFolder folder(world);
    const auto path = folder.file("a.h5");
    write_state(path, world);
    storage::CheckpointFacts facts;
    const std::string other_case = reason(path, {"0", "abc"}, world, facts);
    CHECK(other_case == "belongs to another case");
    const std::string other_program = reason(path, {"00ff", "abd"}, world, facts);
    CHECK(other_program == "was written by another program, abc");
    on_root(world, [&] {
        h5::Id file = h5::open_file(path, h5::Access::read_write);
        file.close("close");
    });
    const std::string without = reason(path, owner, world, facts);
    CHECK(without == "does not end in its checksum: it was truncated or changed, or is not a "
                     "checkpoint of this version");
}

TEST_CASE("detects every changed bit and every truncation of a checkpoint", "[mpi]") {
    const Comm world = Comm::world();
    const SharedFolder folder(world);
    const auto path = folder.file("a.h5");
    write_state(path, world);
    std::string accepted;
    on_root(world, [&] {
        storage::CheckpointFacts facts;
        const std::string sound = storage::read_file(path);
        // The superblock, metadata, arrays, scalars and the line with the checksum.
        for (std::size_t at = 0; at < sound.size(); at += 7) {
            std::string changed = sound;
            changed[at] = static_cast<char>(changed[at] ^ 0x10);
            std::ofstream(path, std::ios::binary) << changed;
            if (storage::checkpoint_error(path, owner, facts).empty())
                accepted += fmt::format(" bit of byte {}", at);
            std::ofstream(path, std::ios::binary) << sound.substr(0, at);
            if (storage::checkpoint_error(path, owner, facts).empty())
                accepted += fmt::format(" {} bytes", at);
        }
    });
    CHECK(accepted.empty());
}

} // namespace test_checkpoint_file
