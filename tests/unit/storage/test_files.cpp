// SPDX-License-Identifier: BSD-3-Clause
#include "storage/files.hpp"

#include "base/error.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

namespace test_files {

using namespace shearwake;

TEST_CASE("a file is written completely and read back byte for byte", "[files]") {
    const test::TemporaryFolder folder;
    const std::string bytes("a\0b\r\n\xff", 6);
    storage::write_file(folder / "x", bytes);
    CHECK(storage::read_file(folder / "x") == bytes);
    storage::write_file(folder / "x", "shorter");
    CHECK(storage::read_file(folder / "x") == "shorter");
    CHECK_FALSE(std::filesystem::exists(folder / "x.part"));
}

TEST_CASE("an error of the file system is an environment error with the reason", "[files]") {
    const test::TemporaryFolder folder;
    storage::write_file(folder / "file", "");
    const auto code_of = [](const auto& work) {
        try {
            work();
        } catch (const UsageError& error) {
            CHECK_FALSE(std::string(error.what()).empty());
            return error.code();
        }
        return ExitCode::done;
    };
    CHECK(code_of([&] { storage::read_file(folder / "none"); }) == ExitCode::environment);
    CHECK(code_of([&] { storage::read_file(folder / ""); }) == ExitCode::environment); // a folder
    CHECK(code_of([&] { storage::write_file(folder / "file/below", "x"); }) ==
          ExitCode::environment);
    CHECK(code_of([&] { storage::make_directory(folder / "file/below"); }) ==
          ExitCode::environment);
    CHECK(code_of([&] { storage::append_line(folder / "none/x", "x"); }) == ExitCode::environment);
}

TEST_CASE("lines are appended", "[files]") {
    const test::TemporaryFolder folder;
    storage::append_line(folder / "x", "one");
    storage::append_line(folder / "x", "two");
    CHECK(storage::read_file(folder / "x") == "one\ntwo\n");
}

} // namespace test_files
