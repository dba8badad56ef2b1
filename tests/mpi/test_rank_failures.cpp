// SPDX-License-Identifier: BSD-3-Clause
// Failures of one rank while its team computes a case. Replaces operator new, to refuse memory.
#include "base/error.hpp"
#include "engines/registry/check.hpp"
#include "engines/registry/make_engine.hpp"
#include "parallel/agree.hpp"
#include "pipeline/run_case.hpp"
#include "storage/case_file/case_file_reader.hpp"
#include "storage/case_file/groups.hpp"
#include "storage/journal/plan_file.hpp"
#include "support/shared_folder.hpp"
#include "support/spectral_cases.hpp"

#include <catch2/catch.hpp>

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>

using namespace shearwake;

namespace {

std::atomic<long> allocations{0}, refused{-1};
/// The refused request is one whose sender continues without the memory.
std::atomic<bool> has_substitute{false};

void* memory_of(std::size_t size, std::size_t alignment) {
    void* memory = nullptr;
    return ::posix_memalign(&memory, alignment, size > 0 ? size : 1) == 0 ? memory : nullptr;
}

bool refuse_this_one() {
    return allocations.fetch_add(1) + 1 == refused.load();
}

void* allocate(std::size_t size, std::size_t alignment) {
    void* memory = refuse_this_one() ? nullptr : memory_of(size, alignment);
    if (!memory) throw std::bad_alloc();
    return memory;
}

/// Not inlined, since g++ 14 warns of std::free where it sees that the memory is of operator new.
[[gnu::noinline]] void release(void* memory) {
    std::free(memory);
}

} // namespace

void* operator new(std::size_t size) {
    return allocate(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { // std::stable_sort
    if (!refuse_this_one()) return memory_of(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
    has_substitute = true;
    return nullptr;
}
void operator delete(void* memory) noexcept {
    release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    release(memory);
}

namespace {

/// Counts the allocations of this rank. The one with this number, from 1, is refused; 0: none.
class Refusal {
public:
    explicit Refusal(long which) {
        allocations = 0;
        has_substitute = false;
        refused = which > 0 ? which : -1;
    }
    ~Refusal() { refused = -1; }
    Refusal(const Refusal&) = delete;
    Refusal& operator=(const Refusal&) = delete;

    long count() const { return allocations.load(); }
    bool met_a_substitute() const { return has_substitute.load(); }
};

Case with_records(Case c) {
    c.measure.at_s = c.time.duration_s();
    c.measure.settled_after_s = 0.0;
    c.record.frames = true;
    c.record.traces_m = {{0.0, 0.0}, {2e-3, 1e-3}};
    return c;
}

Case with_volumes(Case c) {
    c.record.volumes_s = {c.time.duration_s()};
    c.record.volume_fields = {VolumeField::u};
    return c;
}

Case layered_case() {
    Case c = with_records(test::thin_layer(1.0));
    c.solver = LayeredOptions{};
    return c;
}

Case spectral_case() {
    return with_volumes(with_records(test::thin_layer(4.0)));
}

Case pstd_case() {
    Case c = with_volumes(with_records(test::thin_layer(1.0)));
    c.scene.medium = test::half_space(test::tissue(50.0, 0.2));
    c.scene.load.footprint = GaussianFootprint{6e-3};
    PstdOptions options;
    options.depth_m = 6e-3;
    options.absorbing_points = 8; // the minimum
    c.solver = options;
    return c;
}

enum class End { complete, failed };

/// Runs cases as `run` does, each in its files.
class Runner {
public:
    Runner(const Case& c, long checkpoint_steps, const Comm& team,
           const std::filesystem::path& folder)
        : case_(c), schedule_{.interval_s = 0.0, .steps = checkpoint_steps}, team_(team),
          folder_(folder), journal_(folder / "journal.jsonl") {}

    End run(const std::string& id) {
        if (!engine_) engine_ = engines::make_engine(case_.solver);
        try {
            fail_together(team_, [&] { compute(id); });
            return End::complete;
        } catch (const CaseFailure&) {
            engine_.reset();
            return End::failed;
        }
    }
    std::filesystem::path file(const std::string& id) const { return folder_ / (id + ".h5"); }

private:
    void compute(const std::string& id) {
        const PlannedCase planned{.id = id, .physics = case_, .settings = {}, .reference_id = ""};
        pipeline::CaseCheckpoints checkpoints(folder_ / id, {id, ""}, schedule_, team_, journal_,
                                              {[] { return false; }, [](const std::string&) {}});
        pipeline::run_case(planned, {.memory_per_rank_B = std::numeric_limits<double>::infinity()},
                           *engine_, team_, file(id), checkpoints, {});
    }

    Case case_;
    pipeline::CheckpointSchedule schedule_;
    const Comm& team_;
    std::filesystem::path folder_;
    storage::Journal journal_;
    std::unique_ptr<engines::Engine> engine_;
};

std::vector<double> surface_of(const std::filesystem::path& path) {
    return h5::read_all(
        h5::open_dataset(h5::open_file(path, h5::Access::read).raw(), "surface/u_z"));
}

/// On the root rank; empty on the others.
std::vector<double> surface_on_root(const Runner& runner, const std::string& id, const Comm& team) {
    std::vector<double> u_z_m;
    on_root(team, [&] { u_z_m = surface_of(runner.file(id)); });
    return u_z_m;
}

/// Number of refusals per engine and rank.
long refusals() {
    return std::getenv("SHEARWAKE_LONG") ? 60 : 16;
}

struct Seen {
    int failed = 0, complete = 0, substitutes = 0;
};

/// Refuses one allocation of `victim` per run, at places spread over the whole case. Every failed
/// case is followed by one that succeeds, since the same engine and team are used.
Seen refuse_memory(Runner& runner, const Comm& team, int victim, long all) {
    const std::vector<double> whole = surface_on_root(runner, "whole", team);
    Seen seen;
    for (long i = 0; i < refusals(); ++i) {
        const long which = 1 + i * all / refusals();
        End end;
        {
            const Refusal refusal(team.rank() == victim ? which : 0);
            end = runner.run("refused");
            seen.substitutes += team.max(refusal.met_a_substitute() ? 1 : 0);
        }
        // All ranks agree.
        REQUIRE(team.max(end == End::failed ? 1 : 0) == team.min(end == End::failed ? 1 : 0));
        ++(end == End::failed ? seen.failed : seen.complete);
        if (end == End::complete) { // what was refused could be done without
            const bool is_same = surface_on_root(runner, "refused", team) == whole;
            REQUIRE(team.min(is_same ? 1 : 0) == 1);
        }
    }
    return seen;
}

} // namespace

TEST_CASE("memory refused to one rank at any place fails its case only",
          "[mpi][faults][extended]") {
    const Comm team = Comm::world().split(0);
    const test::SharedFolder folder(team);
    // With their steps between checkpoints; 0: none are written.
    using Choice = std::pair<Case, long>;
    const auto [c, checkpoint_steps] =
        GENERATE(Choice{layered_case(), 0}, Choice{spectral_case(), 0}, Choice{spectral_case(), 3},
                 Choice{pstd_case(), 0}, Choice{pstd_case(), 40});
    for (const Remark& remark : check(c))
        if (remark.severity == Severity::error) FAIL(remark.key << ": " << remark.message);
    Runner runner(c, checkpoint_steps, team, folder.file(""));
    REQUIRE(runner.run("warm") == End::complete); // creates FFTW wisdom
    long all = 0;
    {
        const Refusal counting(0);
        REQUIRE(runner.run("whole") == End::complete);
        all = counting.count();
    }
    for (int victim = 0; victim < team.size(); ++victim) {
        const Seen seen = refuse_memory(runner, team, victim, team.broadcast(all, victim));
        if (checkpoint_steps == 0)
            CHECK(seen.failed == refusals() - seen.substitutes);
        else // a checkpoint that cannot be written is skipped
            CHECK(seen.failed >= 1);
        REQUIRE(runner.run("after") == End::complete);
        CHECK(surface_on_root(runner, "after", team) == surface_on_root(runner, "whole", team));
    }
}

TEST_CASE("lines composed for a case pass on that memory is refused", "[faults]") {
    const std::vector<Remark> warnings{{Severity::warning, "domain", "a text longer than 16 bytes"},
                                       {Severity::error, "time", "another one"}};
    const std::vector<Setting> settings{{"load.speed_m_s", 7.0}, {"load.shape", "a circle"}};
    const auto compose = [&] {
        return storage::warnings_text(warnings) + storage::settings_text(settings);
    };
    const std::string whole = compose();
    long refusals = 0;
    for (std::string text; text != whole; ++refusals) {
        const Refusal refusal(refusals + 1);
        try {
            text = compose();
        } catch (const std::bad_alloc&) { // a destructor that needs memory ends the process instead
        }
    }
    CHECK(refusals > 10);
}

TEST_CASE("an exception of one rank ends nested scopes on all ranks", "[mpi][faults]") {
    const Comm team = Comm::world().split(0);
    const int last = team.size() - 1;
    for (int place = 0; place < 6; ++place) {
        const auto fail_at = [&](int here) {
            if (here == place && team.rank() == last) throw std::bad_alloc();
        };
        int caught_inside = 0;
        const auto work = [&] {
            fail_at(0);
            team.barrier();
            fail_at(1);
            try {
                fail_together(team, [&] {
                    fail_at(2);
                    team.sum(1.0);
                    fail_at(3);
                });
            } catch (const CaseFailure&) {
                ++caught_inside;
            }
            fail_at(4);
            team.broadcast(std::string("some text"));
            fail_at(5);
        };
        const bool inside = place == 2 || place == 3;
        if (inside)
            CHECK_NOTHROW(fail_together(team, work));
        else
            CHECK_THROWS_AS(fail_together(team, work), CaseFailure);
        CHECK(caught_inside == (inside ? 1 : 0));
        CHECK(team.sum(1.0) == team.size()); // the team can be used again
    }
}

TEST_CASE("fail_together keeps the types of errors", "[mpi][faults]") {
    const Comm team = Comm::world().split(0);
    const auto of_last_rank = [&](const auto& error) {
        return [&] {
            if (team.rank() == team.size() - 1) throw error;
            team.barrier();
        };
    };
    CHECK_THROWS_AS(fail_together(team, of_last_rank(UsageError("a"))), UsageError);
    CHECK_THROWS_AS(fail_together(team, of_last_rank(FileFailure("a", Persistence::passing))),
                    FileFailure);
    CHECK_THROWS_AS(fail_together(team, of_last_rank(FieldDiverges("a"))), FieldDiverges);
    CHECK_THROWS_WITH(fail_together(team, of_last_rank(Error("the reason"))), "the reason");
    CHECK_THROWS_WITH(fail_together(team, of_last_rank(std::bad_alloc())), "out of memory");
    CHECK_NOTHROW(fail_together(team, [&] { team.barrier(); }));
}
