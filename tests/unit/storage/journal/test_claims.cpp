// SPDX-License-Identifier: BSD-3-Clause
#include "storage/journal/claims.hpp"

#include "base/error.hpp"
#include "storage/files.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <string>
#include <vector>

namespace test_claims {

using namespace shearwake;
using Answer = storage::CaseClaims::Answer;
using State = storage::RunWatch::State;

TEST_CASE("a run is active until it ends", "[claims]") {
    const test::TemporaryFolder folder;
    const std::string name = storage::process_name();
    storage::RunWatch watch(folder / "");
    CHECK(watch.look(name) == State::ended);
    {
        const storage::ActiveRun run(folder / "");
        CHECK(watch.look(name) == State::active);
        CHECK(storage::active_runs(folder / "") == std::vector{name});
        CHECK_THROWS_AS(storage::require_no_run(folder / ""), UsageError);
    }
    CHECK(watch.look(name) == State::ended);
    CHECK_NOTHROW(storage::require_no_run(folder / ""));
    CHECK_THROWS_AS(storage::ActiveRun(folder / "none"), UsageError);
}

TEST_CASE("a run of another host is active while its count increases", "[claims]") {
    const test::TemporaryFolder folder;
    std::ofstream(folder / "elsewhere-17.run") << "0\n";
    storage::RunWatch watch(folder / "");
    CHECK(watch.look("elsewhere-17") == State::unknown);
    CHECK(watch.look("elsewhere-17") == State::unknown);
    std::ofstream(folder / "elsewhere-17.run") << "1\n";
    CHECK(watch.look("elsewhere-17") == State::active);
    storage::remove_ended_runs(folder / ""); // it may be active
    CHECK(std::filesystem::exists(folder / "elsewhere-17.run"));
}

TEST_CASE("a case is claimed by one run, and inherited from one that has ended", "[claims]") {
    const test::TemporaryFolder folder;
    const storage::ActiveRun run(folder / "");
    storage::CaseClaims mine(folder / "", storage::process_name()), other(folder / "", "ended-1");
    CHECK(mine.claim("a") == Answer::granted);
    CHECK(other.claim("a") == Answer::refused);
    CHECK(storage::claimed_by(folder / "", "a") == storage::process_name());
    other.release("a"); // that of another run
    CHECK(mine.holds("a"));
    mine.release("a");
    CHECK(other.claim("a") == Answer::granted);
    CHECK(mine.claim("a") == Answer::inherited);
    CHECK_FALSE(other.holds("a"));
    std::ofstream(folder / "b.case"); // of a run that was killed before it wrote its name
    CHECK(mine.claim("b") == Answer::inherited);
    storage::CaseClaims nowhere(folder / "none", "run-1");
    CHECK_THROWS_AS(nowhere.claim("a"), UsageError);
}

} // namespace test_claims
