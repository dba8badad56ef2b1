#include "base/error.hpp"
#include "parallel/agree.hpp"
#include "parallel/shared_counters.hpp"

#include <catch2/catch.hpp>
#include <numeric>

using namespace shearwake;

TEST_CASE("one rank's failure is everybody's, with the lowest rank's words", "[mpi]") {
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
    // A usage error stays one, with its code; running out of memory is the case's trouble.
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

TEST_CASE("the shared counter gives every number exactly once", "[mpi]") {
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

TEST_CASE("gathering keeps the order of ranks, also with uneven and empty shares", "[mpi]") {
    const Comm world = Comm::world();
    const auto count = static_cast<std::size_t>(world.rank() % 3); // rank 0 has none
    const std::vector<double> mine(count, world.rank());
    std::vector<double> expected;
    for (int rank = 0; rank < world.size(); ++rank)
        expected.insert(expected.end(), static_cast<std::size_t>(rank % 3), rank);
    CHECK(world.all_gather(std::span<const double>(mine)) == expected);
    const auto on_rank_0 = world.gather(mine);
    const bool fine = world.is_root() ? on_rank_0 == expected : on_rank_0.empty();
    CHECK(world.max(fine ? 0 : 1) == 0);
}

TEST_CASE("teams split the world and text reaches all of it", "[mpi]") {
    const Comm world = Comm::world();
    const Comm team = world.split(world.rank() % 2);
    CHECK(team.sum(1.0) == team.size());
    CHECK(world.broadcast(world.is_root() ? std::string("job\0text", 8) : std::string()) ==
          std::string("job\0text", 8));
    CHECK(world.broadcast(static_cast<long>(world.rank()), world.size() - 1) == world.size() - 1);
}
