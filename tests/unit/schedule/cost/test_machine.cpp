// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/machine.hpp"

#include "storage/files.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <thread>
#include <vector>

namespace test_machine {

using namespace shearwake;

namespace {

cost::Machine some_machine() {
    return {.rates = {{"layered.frame", 3.25e-9}, {"pstd.step", 1.0 / 3.0}},
            .message_s = 1e-6,
            .transposed_B_s = 2e9,
            .file_s = 0.01,
            .written_B_s = 1e8,
            .measured = "on a, 2 ranks, today"};
}

void replace(const std::filesystem::path& file, const std::string& what, const std::string& with) {
    std::string text = storage::read_file(file);
    const auto at = text.find(what);
    REQUIRE(at != std::string::npos);
    storage::write_file(file, text.replace(at, what.size(), with));
}

} // namespace

TEST_CASE("a calibration reads back as it was written", "[machine]") {
    const test::TemporaryFolder folder;
    const auto file = folder / "deep" / "machine.json";
    CHECK(cost::read_machine(file) == cost::Machine{}); // none yet
    CHECK(cost::keep_machine(some_machine(), file));
    CHECK(cost::read_machine(file) == some_machine());
    CHECK(cost::machine_of_root(some_machine(), Comm::world()) == some_machine());
}

TEST_CASE("an engine that is measured later is added to the file", "[machine]") {
    const test::TemporaryFolder folder;
    const auto file = folder / "machine.json";
    cost::keep_machine(some_machine(), file);
    cost::Machine later = some_machine();
    later.rates = {{"layered.frame", 4e-9}, {"spectral.solve", 2e-9}};
    cost::keep_machine(later, file);
    const engines::Rates rates = cost::read_machine(file).rates;
    CHECK(rates.size() == 3);
    CHECK(rates.at("layered.frame") == 4e-9);
}

TEST_CASE("a file that is damaged or foreign is measured again", "[machine]") {
    const test::TemporaryFolder folder;
    const auto file = folder / "machine.json";
    cost::keep_machine(some_machine(), file);
    SECTION("cut short") {
        const std::string text = storage::read_file(file);
        storage::write_file(file, text.substr(0, text.size() / 2));
    }
    SECTION("empty") {
        storage::write_file(file, "");
    }
    SECTION("of another processor") {
        replace(file, "\"processor\": \"", "\"processor\": \"0");
    }
    SECTION("of another program") {
        replace(file, "\"program\": \"shearwake", "\"program\": \"shearwave");
    }
    SECTION("a rate that is not positive") {
        replace(file, "3.25e-09", "-3.25e-09");
    }
    CHECK(cost::read_machine(file) == cost::Machine{});
    CHECK(cost::keep_machine(some_machine(), file)); // and replaced
    CHECK(cost::read_machine(file) == some_machine());
}

TEST_CASE("accepts a cache folder that cannot be written", "[machine]") {
    const test::TemporaryFolder folder;
    storage::write_file(folder / "file", "");
    CHECK_FALSE(cost::keep_machine(some_machine(), folder / "file" / "machine.json"));
    CHECK(cost::read_machine(folder / "file" / "machine.json") == cost::Machine{});
}

TEST_CASE("whoever reads while others write finds a complete calibration", "[machine]") {
    const test::TemporaryFolder folder;
    const auto file = folder / "machine.json";
    cost::keep_machine(some_machine(), file);
    std::vector<std::thread> writers;
    for (int w = 0; w < 3; ++w)
        writers.emplace_back([&] {
            for (int i = 0; i < 50; ++i)
                cost::keep_machine(some_machine(), file);
        });
    int damaged = 0;
    for (int i = 0; i < 200; ++i)
        damaged += cost::read_machine(file) == some_machine() ? 0 : 1;
    for (std::thread& writer : writers)
        writer.join();
    CHECK(damaged == 0);
    std::size_t files = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder / ""))
        ++files;
    CHECK(files == 1);
}

} // namespace test_machine
