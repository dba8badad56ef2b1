// SPDX-License-Identifier: BSD-3-Clause
#include "storage/checksum/checksum.hpp"

#include "storage/files.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <fstream>

namespace test_part_checksum {

using namespace shearwake;
using namespace shearwake::storage;

static void put_bytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

static std::string with_flip(std::string bytes, std::size_t at) {
    bytes[at] = static_cast<char>(bytes[at] ^ 4);
    return bytes;
}

TEST_CASE("an unfinished file is compared with its state at the checkpoint", "[checksum]") {
    const test::TemporaryFolder folder;
    const auto path = folder / "a.h5.part";
    const std::string bytes(1000, 'x');
    put_bytes(path, bytes);
    // Two fields, of 200 and 300 bytes, half-written, in any order.
    const std::vector<FieldBytes> fields = {{500, 300, 100}, {100, 200, 200}};
    PartChecksum checksum;
    const std::string record = checksum.record(path, fields);
    CHECK(bytes_error(path, record).empty());
    CHECK(fields_of(record).at(1).written == 200);
    // What is not written yet may change: the run went on after the checkpoint.
    put_bytes(path, with_flip(bytes, 650));
    CHECK(bytes_error(path, record).empty());
    for (const std::size_t at : {0U, 99U, 100U, 299U, 300U, 499U, 500U, 599U, 800U, 999U}) {
        put_bytes(path, with_flip(bytes, at));
        INFO(at);
        CHECK_FALSE(bytes_error(path, record).empty());
    }
    put_bytes(path, bytes.substr(0, 700));
    CHECK_FALSE(bytes_error(path, record).empty());
    CHECK_FALSE(bytes_error(folder / "none", record).empty());
    CHECK_FALSE(bytes_error(path, "").empty());
}

TEST_CASE("an incremental checksum equals that of the whole file", "[checksum]") {
    const test::TemporaryFolder folder;
    const auto path = folder / "a.h5.part";
    put_bytes(path, std::string(700000, 'y'));
    PartChecksum growing;
    for (const std::uint64_t written : {0U, 8U, 300000U, 600000U}) {
        const std::vector<FieldBytes> fields = {{64, 600000, written}};
        CHECK(growing.record(path, fields) == PartChecksum().record(path, fields));
    }
}

} // namespace test_part_checksum
