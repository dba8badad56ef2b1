// SPDX-License-Identifier: BSD-3-Clause
#include "storage/checksum/checksum.hpp"

#include "base/error.hpp"
#include "storage/case_file/case_file_reader.hpp"
#include "storage/case_file/case_file_writer.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/files.hpp"
#include "storage/journal/plan_file.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <random>
#include <string>

namespace test_file_checksum {

using namespace shearwake;
using namespace shearwake::storage;

static CaseDigest write_case(const std::filesystem::path& path) {
    const Comm alone = Comm::world().split(Comm::world().rank());
    CaseFileWriter writer(path, alone, {Domain{4, 4, 1e-3, 0.0}, {0.1, 0.2}, {0.0}});
    const std::vector<double> field(16, 1.0);
    for (std::size_t t = 0; t < 2; ++t)
        writer.write_surface(t, 0, View2<const double>(field.data(), 4, 4), 0);
    const std::vector<VariableGroup> groups = {{"",
                                                {{"time", {"time"}, {0.1, 0.2}, "s", "time", ""},
                                                 {"eta_period_1", {}, {0.503}, "1", "eta", ""}}}};
    const std::vector<Attribute> attributes = {{"title", std::string("t")},
                                               {"case_id", std::string("00ff")},
                                               {"status", std::string("complete")}};
    writer.commit(groups, attributes);
    return digest_of(groups, attributes);
}

static void put_bytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

static bool is_accepted(const std::filesystem::path& path) {
    try {
        read_case_summary(path);
        return true;
    } catch (const Error&) {
        return false;
    }
}

TEST_CASE("flipped bits of a case file are detected", "[checksum]") {
    const test::TemporaryFolder folder;
    const auto whole = folder / "00ff.h5", damaged = folder / "damaged.h5";
    write_case(whole);
    const std::string bytes = read_file(whole);
    REQUIRE(check_integrity(whole).damage.empty());
    std::mt19937 chance(16);
    std::size_t accepted = 0;
    const std::size_t stride = std::getenv("SHEARWAKE_LONG") ? 1 : 10;
    for (std::size_t at = 0; at < bytes.size(); at += stride) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ (1 << (chance() % 8)));
        put_bytes(damaged, changed);
        accepted += is_accepted(damaged) ? 1 : 0;
    }
    CHECK(accepted == 0);
}

TEST_CASE("every truncation or extension of a case file is detected", "[checksum]") {
    const test::TemporaryFolder folder;
    const auto whole = folder / "00ff.h5", damaged = folder / "damaged.h5";
    write_case(whole);
    const std::string bytes = read_file(whole);
    std::size_t accepted = 0;
    const std::size_t stride = bytes.size() / 210;
    for (std::size_t cut = 1; cut <= bytes.size(); cut += cut < 120 ? 1 : stride) {
        put_bytes(damaged, bytes.substr(0, bytes.size() - cut));
        accepted += is_accepted(damaged) ? 1 : 0;
    }
    put_bytes(damaged, bytes + "\n");
    accepted += is_accepted(damaged) ? 1 : 0;
    put_bytes(damaged, bytes + bytes);
    accepted += is_accepted(damaged) ? 1 : 0;
    CHECK(accepted == 0);
}

TEST_CASE("a file without a checksum is damaged", "[checksum]") {
    const test::TemporaryFolder folder;
    make_directory(folder / "cases");
    const auto path = folder / "cases/00ff.h5";
    {
        h5::Id file = h5::open_file(path, h5::Access::create);
        for (const auto& [name, value] :
             {std::pair{"title", "t"}, {"case_id", "00ff"}, {"status", "complete"}})
            h5::put_attribute(file.raw(), name, std::string(value));
        file.close("close");
    }
    CHECK(check_integrity(path).damage.starts_with("the checksum at its end is missing"));
    CHECK_FALSE(is_accepted(path));
    CaseIndex index(folder / "", CaseIndex::Trust::checksum);
    REQUIRE(index.find("00ff"));
    CHECK(index.find("00ff")->is_lost);
}

TEST_CASE("the checksum line is the published hash of the bytes", "[checksum]") {
    const std::map<std::size_t, std::string> hashes = {
        // XXH3-128 by python3-xxhash
        {0, "99aa06d3014798d86001c324468d497f"},
        {1, "a6cd5e9392000f6ac44bdff4074eecdb"},
        {1 << 18, "cfcc66598820083371c3ee631ba65c07"},
        {300001, "49eb3d20df4c858b6d187c54d33b1858"}};
    const test::TemporaryFolder folder;
    for (const auto& [length, hash] : hashes) {
        std::string bytes(length, 'a');
        for (std::size_t i = 0; i < length; ++i)
            bytes[i] = static_cast<char>(i * i % 251);
        put_bytes(folder / "f", bytes);
        append_checksum(folder / "f");
        CHECK(read_file(folder / "f")
                  .ends_with(fmt::format("shearwake checksum 1 XXH3-128 {} of {:020} bytes\n", hash,
                                         length)));
        CHECK(check_integrity(folder / "f").damage.empty());
    }
}

TEST_CASE("a changed line of the index is ignored", "[checksum]") {
    const test::TemporaryFolder folder;
    make_directory(folder / "cases");
    const CaseDigest digest = write_case(folder / "cases/00ff.h5");
    add_to_index(folder / "index.jsonl", folder / "cases/00ff.h5", digest);
    std::string line = read_file(folder / "index.jsonl");
    const auto at = line.find("0.503");
    REQUIRE(at != std::string::npos);
    line[at + 2] = '9';
    write_file(folder / "index.jsonl", line);
    CaseIndex index(folder / "");
    REQUIRE(index.find("00ff"));
    CHECK(index.find("00ff")->scalars.back().value == 0.503);
    CHECK(index.lines_skipped() == 1);
}

TEST_CASE("detected damage is recorded for the next run", "[checksum]") {
    const test::TemporaryFolder folder;
    make_directory(folder / "cases");
    const auto path = folder / "cases/00ff.h5";
    write_case(path);
    std::string bytes = read_file(path);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    put_bytes(path, bytes);
    {
        CaseIndex index(folder / "", CaseIndex::Trust::checksum);
        CHECK_FALSE(index.is_complete("00ff"));
        index.save();
    }
    CHECK(read_file(folder / "index.jsonl").find("do not match") != std::string::npos);
    CaseIndex index(folder / "");
    REQUIRE(index.find("00ff"));
    CHECK(index.find("00ff")->is_lost);
}

TEST_CASE("a sealed text detects every change", "[checksum]") {
    const std::string text = "{\"v\":2,\"a\":[0.5,\"b\"]}\n";
    const std::string sealed = seal(text);
    CHECK(unseal(sealed) == text);
    CHECK(unseal(text) == std::nullopt);
    CHECK(unseal("") == std::nullopt);
    for (std::size_t at = 0; at < sealed.size(); ++at)
        for (int bit = 0; bit < 8; ++bit) {
            std::string changed = sealed;
            changed[at] = static_cast<char>(changed[at] ^ (1 << bit));
            CHECK(unseal(changed) == std::nullopt);
        }
}

} // namespace test_file_checksum
