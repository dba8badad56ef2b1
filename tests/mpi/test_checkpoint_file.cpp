// SPDX-License-Identifier: BSD-3-Clause
#include "storage/checkpoint/checkpoint_file.hpp"

#include "base/error.hpp"
#include "support/shared_folder.hpp"

#include <catch2/catch.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <vector>

namespace test_checkpoint_file {

using namespace shearwake;
using test::SharedFolder;

namespace {

const storage::CheckpointOwner owner{"00ff", "abc"};
constexpr std::ptrdiff_t total = 4, row_length = 3; // uneven on 3 ranks; one of 5 ranks has none

/// Blocks of rows in ascending or descending order of ranks.
enum class Order { forward, reverse };
DistributedRows rows_of(const Comm& world, Order order) {
    const std::ptrdiff_t place =
        order == Order::forward ? world.rank() : world.size() - 1 - world.rank();
    const std::ptrdiff_t each = (total + world.size() - 1) / world.size();
    const std::ptrdiff_t start = std::min(total, place * each);
    return {total, start, std::min(total, start + each) - start, row_length};
}

double value_at(std::ptrdiff_t row, std::ptrdiff_t column) {
    if (row == 2 && column == 1) return -0.0;
    if (row == 3 && column == 2) return std::numeric_limits<double>::denorm_min();
    return 1.0 / static_cast<double>(1 + 10 * row + column);
}

std::vector<double> values_of(const DistributedRows& rows) {
    std::vector<double> values;
    for (std::ptrdiff_t i = rows.start; i < rows.start + rows.count; ++i)
        for (std::ptrdiff_t j = 0; j < rows.row_length; ++j)
            values.push_back(value_at(i, j));
    return values;
}

void write_state(const std::filesystem::path& path, const Comm& world) {
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
std::string reason(const std::filesystem::path& path, const storage::CheckpointOwner& wanted,
                   const Comm& world, storage::CheckpointFacts& facts) {
    std::string text;
    on_root(world, [&] { text = storage::checkpoint_error(path, wanted, facts); });
    return world.broadcast(text);
}

void flip_bit(const std::filesystem::path& path, std::streamoff at) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(at);
    const char byte = static_cast<char>(file.get() ^ 0x10);
    file.seekp(at);
    file.put(byte);
}

} // namespace

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
    const std::string damage = reader.damage();
    CHECK(damage.empty());
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
        on_root(world, [&] { part = std::filesystem::exists(path.string() + ".part"); });
        CHECK(part);
    }
    world.barrier();
    CHECK_FALSE(std::filesystem::exists(path.string() + ".part"));
    CHECK(storage::CheckpointFileReader(path, world).get("step") == 17.0);
}

TEST_CASE("reports a checkpoint of another case or program and an incomplete one", "[mpi]") {
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
        h5::check(H5Adelete(file.raw(), "whole"), "delete");
    });
    const std::string half = reason(path, owner, world, facts);
    CHECK(half == "is not complete");
    on_root(world, [&] { std::filesystem::resize_file(path, 1000); });
    const std::string truncated = reason(path, owner, world, facts);
    CHECK(truncated.substr(0, 10) == "is damaged");
}

TEST_CASE("detects a single changed bit in a checkpoint", "[mpi]") {
    const Comm world = Comm::world();
    const SharedFolder folder(world);
    const auto path = folder.file("a.h5");
    write_state(path, world);
    on_root(world, [&] {
        // Find the position of the numbers. The scalars have a digest, "u" has a checksum.
        h5::Id file = h5::open_file(path, h5::Access::read);
        const h5::Id u = h5::open_dataset(file.raw(), "u");
        const haddr_t offset = H5Dget_offset(u.raw());
        flip_bit(path, static_cast<std::streamoff>(offset) + 11);
    });
    storage::CheckpointFacts facts;
    const std::string by_attributes = reason(path, owner, world, facts);
    CHECK(by_attributes.empty());
    const std::string damage = storage::CheckpointFileReader(path, world).damage();
    CHECK(damage == "is damaged (u does not match its checksum)");
    on_root(world, [&] {
        h5::Id file = h5::open_file(path, h5::Access::read_write);
        const h5::Id group = h5::open_group(file.raw(), "scalars");
        h5::check(H5Adelete(group.raw(), "step"), "delete");
        h5::put_attribute(group.raw(), "step", 16.0);
    });
    const std::string scalars = reason(path, owner, world, facts);
    CHECK(scalars == "is damaged (its scalars do not match their checksum)");
}

} // namespace test_checkpoint_file
