#include "io/files.hpp"

#include "base/error.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

using namespace shearwake;

TEST_CASE("a file is written whole and read back byte for byte", "[files]") {
    const test::TemporaryFolder folder;
    const std::string bytes("a\0b\r\n\xff", 6);
    write_file(folder / "x", bytes);
    CHECK(read_file(folder / "x") == bytes);
    write_file(folder / "x", "shorter");
    CHECK(read_file(folder / "x") == "shorter");
    CHECK_FALSE(std::filesystem::exists(folder / "x.part"));
}

TEST_CASE("what the file system refuses is the environment's error, with its reason", "[files]") {
    const test::TemporaryFolder folder;
    write_file(folder / "file", "");
    const auto code_of = [](const auto& work) {
        try {
            work();
        } catch (const UsageError& error) {
            CHECK_FALSE(std::string(error.what()).empty());
            return error.code();
        }
        return ExitCode::done;
    };
    CHECK(code_of([&] { read_file(folder / "none"); }) == ExitCode::environment);
    CHECK(code_of([&] { read_file(folder / ""); }) == ExitCode::environment); // a folder
    CHECK(code_of([&] { write_file(folder / "file/below", "x"); }) == ExitCode::environment);
    CHECK(code_of([&] { make_directory(folder / "file/below"); }) == ExitCode::environment);
    CHECK(code_of([&] { append_line(folder / "none/x", "x"); }) == ExitCode::environment);
}

TEST_CASE("lines are appended", "[files]") {
    const test::TemporaryFolder folder;
    append_line(folder / "x", "one");
    append_line(folder / "x", "two");
    CHECK(read_file(folder / "x") == "one\ntwo\n");
}
