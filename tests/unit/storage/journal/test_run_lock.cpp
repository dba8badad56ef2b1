// SPDX-License-Identifier: BSD-3-Clause
#include "storage/journal/run_lock.hpp"

#include "base/error.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"
#include "support/temporary_folder.hpp"

#include <atomic>
#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <fstream>
#include <optional>
#include <thread>

namespace test_run_lock {

using namespace shearwake;
using Sharing = storage::RunLock::Sharing;

namespace {

/// Overwrites the file as a run does, which never leaves it empty.
void write_count(const std::filesystem::path& file, int beat) {
    std::fstream(file, std::ios::in | std::ios::out) << fmt::format("another-host 17 {}\n", beat);
}

} // namespace

TEST_CASE("a folder is locked by one complete run or by several runs of parts", "[lock]") {
    const test::TemporaryFolder folder;
    CHECK_FALSE(storage::is_locked(folder / "run").has_value()); // there is none
    {
        const storage::RunLock alone(folder / "run", Sharing::alone);
        CHECK(storage::is_locked(folder / "run") == true);
        CHECK_THROWS_AS(storage::RunLock(folder / "run", Sharing::alone), UsageError);
        CHECK_THROWS_AS(storage::RunLock(folder / "run", Sharing::with_others), UsageError);
    }
    CHECK(storage::is_locked(folder / "run") == false);
    const storage::RunLock first(folder / "run", Sharing::with_others);
    CHECK_NOTHROW(storage::RunLock(folder / "run", Sharing::with_others));
    CHECK_THROWS_AS(storage::RunLock(folder / "run", Sharing::alone), UsageError);
    CHECK_THROWS_AS(storage::RunLock(folder / "none/run", Sharing::alone), UsageError);
}

TEST_CASE("a folder with an increasing count of another host is in use, independent of its locks",
          "[lock]") {
    const test::TemporaryFolder folder;
    std::atomic<bool> ends = false;
    std::ofstream(folder / "run") << "another-host 17 0\n";
    std::thread host([&] {
        for (int beat = 1; !ends; ++beat) {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
            write_count(folder / "run", beat);
        }
    });
    std::string words;
    try {
        const storage::RunLock lock(folder / "run", Sharing::alone);
    } catch (const UsageError& error) {
        words = error.what();
    }
    ends = true;
    host.join();
    CHECK(words.find("process 17 on another-host") != std::string::npos);
}

TEST_CASE("a part with an increasing count of another host is reported and prevents a complete run",
          "[lock]") {
    const test::TemporaryFolder folder;
    const auto short_while = std::chrono::milliseconds(200);
    const storage::RunLock alone(folder / "run", Sharing::alone);
    std::ofstream(folder / "2-of-3") << "another-host 17 5\n";
    CHECK_FALSE(storage::holder_in(folder / "", short_while)); // its count stands still
    CHECK_NOTHROW(storage::refuse_beside_parts(folder / "", short_while));
    std::atomic<bool> ends = false;
    std::thread host([&] {
        for (int beat = 6; !ends; ++beat) {
            write_count(folder / "2-of-3", beat);
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
    });
    const auto holder = storage::holder_in(folder / "");
    std::string words;
    try {
        storage::refuse_beside_parts(folder / "");
    } catch (const UsageError& error) {
        words = error.what();
    }
    ends = true;
    host.join();
    CHECK((holder && holder->host == "another-host" && holder->process == 17));
    CHECK(words.find("process 17 on another-host") != std::string::npos);
}

TEST_CASE("a folder whose count no longer increases is taken over", "[lock]") {
    const test::TemporaryFolder folder;
    std::ofstream(folder / "run") << "another-host 17 5\n";
    CHECK_NOTHROW(storage::RunLock(folder / "run", Sharing::alone, std::chrono::milliseconds(100)));
    std::ofstream(folder / "run") << "another-host 17 5\n";
    const storage::RunLock lock(folder / "run", Sharing::alone, std::chrono::milliseconds(100));
    std::string host;
    std::ifstream(folder / "run") >> host;
    CHECK(host == storage::host_name()); // this one's count stands there now
}

TEST_CASE("a case is claimed once", "[lock]") {
    const test::TemporaryFolder folder;
    const storage::CaseClaims mine(folder / "cases"), other(folder / "cases");
    CHECK(mine.claim(3));
    CHECK_FALSE(other.claim(3));
    CHECK(other.claim(4));
    mine.release(3);
    CHECK(other.claim(3));
    std::optional<storage::CaseClaims> ended(std::in_place, folder / "cases");
    CHECK(ended->claim(9));
    CHECK_FALSE(mine.claim(9));
    ended.reset(); // as at the end of a process
    CHECK(mine.claim(9));
}

} // namespace test_run_lock
