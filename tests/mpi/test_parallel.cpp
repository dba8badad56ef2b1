// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "parallel/agree.hpp"
#include "parallel/shared_counters.hpp"

#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>
#include <unistd.h>

namespace test_parallel {

using namespace shearwake;

TEST_CASE("throws the error of the lowest failed rank on all ranks", "[mpi]") {
    const Comm world = Comm::world();
    std::string words;
    try {
        together(world, [&] {
            if (world.rank() >= world.size() / 2)
                throw Error("rank " + std::to_string(world.rank()));
        });
    } catch (const CaseFailure& failure) {
        words = failure.what();
    }
    CHECK(words == "rank " + std::to_string(world.size() / 2));
    // A usage error keeps its type and exit code; running out of memory becomes a CaseFailure.
    ExitCode code = ExitCode::done;
    try {
        on_root(world, [] { throw UsageError("no disk", ExitCode::environment); });
    } catch (const UsageError& error) {
        code = error.code();
    }
    CHECK(code == ExitCode::environment);
    CHECK_THROWS_AS(together(world, [] { throw std::bad_alloc(); }), CaseFailure);
    CHECK_NOTHROW(together(world, [] {}));
}

TEST_CASE("shared counter returns every number exactly once", "[mpi]") {
    const Comm world = Comm::world();
    const long wanted = 500;
    std::vector<double> mine(static_cast<std::size_t>(wanted), 0.0);
    {
        SharedCounters counters(world, 2);
        for (long next = 0; (next = counters.fetch_add(1, 1)) < wanted;)
            mine[static_cast<std::size_t>(next)] += 1.0;
        world.barrier();
        CHECK(counters.read(1) == wanted + world.size());
        CHECK(counters.read(0) == 0);
    }
    world.sum(mine);
    CHECK(mine == std::vector<double>(static_cast<std::size_t>(wanted), 1.0));
}

TEST_CASE("ranks add to shared counters while rank 0 calls no function of MPI", "[mpi]") {
    const Comm world = Comm::world();
    const std::string stem =
        world.broadcast("/tmp/shearwake-counters-" + std::to_string(::getpid()) + "-");
    const auto file_of = [&](int rank) { return stem + std::to_string(rank); };
    bool have_all_added = true;
    {
        SharedCounters counters(world, 1);
        world.barrier();
        if (!world.is_root()) {
            counters.fetch_add(0, 1);
            std::ofstream(file_of(world.rank())) << "added";
        }
        // Half an hour, which only a rank that waits for rank 0 needs.
        for (int rank = 1; world.is_root() && rank < world.size(); ++rank) {
            for (int n = 0; n < 180000 && !std::filesystem::exists(file_of(rank)); ++n)
                std::this_thread::sleep_for(std::chrono::milliseconds(10));
            have_all_added = have_all_added && std::filesystem::exists(file_of(rank));
        }
        world.barrier();
        std::filesystem::remove(file_of(world.rank()));
        CHECK(counters.read(0) == world.size() - 1);
    }
    CHECK(world.max(have_all_added ? 0 : 1) == 0);
}

TEST_CASE("gathers uneven and empty contributions in the order of ranks", "[mpi]") {
    const Comm world = Comm::world();
    const auto count = static_cast<std::size_t>(world.rank() % 3); // rank 0 has no values
    const std::vector<double> mine(count, world.rank());
    std::vector<double> expected;
    for (int rank = 0; rank < world.size(); ++rank)
        expected.insert(expected.end(), static_cast<std::size_t>(rank % 3), rank);
    CHECK(world.all_gather(mine) == expected);
    const auto on_rank_0 = world.gather(mine);
    const bool fine = world.is_root() ? on_rank_0 == expected : on_rank_0.empty();
    CHECK(world.max(fine ? 0 : 1) == 0);
}

TEST_CASE("all-to-all distributes the parts of all ranks for every type of value", "[mpi]") {
    const Comm world = Comm::world();
    const int n = world.size();
    // Rank r sends s + 1 values to rank s: 100 r + s.
    std::vector<std::ptrdiff_t> to, from;
    std::vector<float> sent;
    std::vector<double> expected;
    for (int other = 0; other < n; ++other) {
        to.push_back(other + 1);
        from.push_back(world.rank() + 1);
        sent.insert(sent.end(), static_cast<std::size_t>(other + 1),
                    static_cast<float>(100 * world.rank() + other));
        expected.insert(expected.end(), static_cast<std::size_t>(world.rank() + 1),
                        100.0 * other + world.rank());
    }
    std::vector<float> received(expected.size());
    world.all_to_all(std::span<const float>(sent), to, std::span(received), from);
    CHECK(std::vector<double>(received.begin(), received.end()) == expected);
    to.back() += 1; // more than the buffer contains
    CHECK_THROWS_AS(world.all_to_all(std::span<const float>(sent), to, std::span(received), from),
                    Error);
}

TEST_CASE("splits the ranks into teams and broadcasts text", "[mpi]") {
    const Comm world = Comm::world();
    const Comm team = world.split(world.rank() % 2);
    CHECK(team.sum(1.0) == team.size());
    CHECK(world.broadcast(world.is_root() ? std::string("job\0text", 8) : std::string()) ==
          std::string("job\0text", 8));
    CHECK(world.broadcast(static_cast<long>(world.rank()), world.size() - 1) == world.size() - 1);
}

TEST_CASE("a spaced question is asked on the root and answered on all ranks in the same call",
          "[mpi]") {
    const Comm world = Comm::world();
    SpacedQuestion question(world, 1e-4);
    int questions = 0;
    std::vector<double> calls_with_yes;
    for (int call = 0; call < 20000; ++call)
        if (question.ask([&] { return ++questions % 3 == 0; })) calls_with_yes.push_back(call);
    CHECK(!calls_with_yes.empty());
    // Calls of well under 1e-4 s are not all asked, and none is asked elsewhere.
    CHECK(questions == (world.is_root() ? questions : 0));
    CHECK(questions < 20000);
    // The same calls on every rank: their number and sum, and thus, as they ascend, none differs.
    double sum = 0.0;
    for (const double call : calls_with_yes)
        sum += call;
    CHECK(world.max(sum) == sum);
    CHECK(world.max(-sum) == -sum);
}

} // namespace test_parallel
