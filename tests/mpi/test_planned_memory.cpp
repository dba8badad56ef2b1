// SPDX-License-Identifier: BSD-3-Clause
// The memory that a run allocates is that of the arrays of its plan. Replaces malloc, to count
// large requests.
#include "engines/registry/make_engine.hpp"
#include "pipeline/afferent_result.hpp"
#include "pipeline/memory.hpp"
#include "pipeline/surface_recorder.hpp"
#include "support/feature_cases.hpp"

#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <cerrno>
#include <cstdint>
#include <fmt/format.h>

namespace {

/// The requests of at least `least_B` bytes whose memory is in use, by address; their sum, and its
/// maximum since it was last set.
class Requests {
public:
    void add(void* memory, std::size_t bytes) {
        if (!memory || bytes < least_B) return;
        const Lock lock(busy_);
        std::size_t at = place(memory);
        while (all_[at].memory)
            at = next(at);
        all_[at] = {memory, bytes};
        now_B += static_cast<long>(bytes);
        if (now_B > most_B) most_B = now_B.load();
    }
    void remove(const void* memory) {
        const Lock lock(busy_);
        std::size_t at = place(memory);
        while (all_[at].memory && all_[at].memory != memory)
            at = next(at);
        if (!all_[at].memory) return;
        now_B -= static_cast<long>(all_[at].bytes);
        // Moves later entries up, so that no search ends early.
        for (std::size_t hole = at, from = next(at);; from = next(from)) {
            all_[hole] = {};
            while (all_[from].memory && is_between(hole, place(all_[from].memory), from))
                from = next(from);
            if (!all_[from].memory) return;
            all_[hole] = all_[from];
            hole = from;
        }
    }
    std::atomic<long> now_B{0}, most_B{0};

private:
    static constexpr std::size_t least_B = 4096, count = std::size_t{1} << 17;
    struct Entry {
        const void* memory;
        std::size_t bytes;
    };
    struct Lock {
        explicit Lock(std::atomic_flag& flag) : busy(flag) {
            while (busy.test_and_set()) {
            }
        }
        ~Lock() { busy.clear(); }
        std::atomic_flag& busy;
    };
    static std::size_t place(const void* memory) {
        return (reinterpret_cast<std::uintptr_t>(memory) >> 4) * 0x9e3779b97f4a7c15ULL >> 47;
    }
    static std::size_t next(std::size_t at) { return (at + 1) % count; }
    /// Whether b is in the cyclic range (a, c].
    static bool is_between(std::size_t a, std::size_t b, std::size_t c) {
        return a < c ? a < b && b <= c : a < b || b <= c;
    }
    std::array<Entry, count> all_{};
    std::atomic_flag busy_{};
};

constinit Requests requests;

void* counted(void* memory, std::size_t bytes) {
    requests.add(memory, bytes);
    return memory;
}

} // namespace

// Those of glibc.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t bytes) {
    return counted(__libc_malloc(bytes), bytes);
}
void* calloc(std::size_t count, std::size_t bytes) {
    return counted(__libc_calloc(count, bytes), count * bytes);
}
void* realloc(void* memory, std::size_t bytes) {
    requests.remove(memory);
    return counted(__libc_realloc(memory, bytes), bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) {
    return counted(__libc_memalign(alignment, bytes), bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
    return memalign(alignment, bytes);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t bytes) {
    *memory = memalign(alignment, bytes);
    return *memory ? 0 : ENOMEM;
}
void free(void* memory) {
    if (memory) requests.remove(memory);
    __libc_free(memory);
}
}

namespace test_planned_memory {

using namespace shearwake;

namespace {

void compute(const Case& c, const pipeline::CasePlan& plan, engines::Engine& engine,
             const Comm& team) {
    pipeline::SurfaceRecorder recorder(c, team, {});
    pipeline::record_receptors(c, plan.receptors, recorder);
    engine.run(c, team, recorder);
    recorder.finish();
    if (!plan.receptors) return;
    const PlannedCase planned{.id = "case", .physics = c, .settings = {}, .reference_id = ""};
    pipeline::simulate_afferents(pipeline::receptor_motion(planned, recorder, *plan.receptors),
                                 *c.afferents, *plan.receptors, team);
}

void check_memory(bool of_long_cases) {
    const Comm world = Comm::world();
    for (const test::FeatureCase& one : test::feature_cases()) {
        if (one.is_long != of_long_cases) continue;
        DYNAMIC_SECTION(one.name) {
            const Case& c = one.physics;
            const auto engine = engines::make_engine(c.solver);
            const pipeline::CasePlan plan = pipeline::plan_case(c, world.size(), *engine);
            const long before_B = requests.now_B;
            requests.most_B = before_B;
            compute(c, plan, *engine, world);
            const double allocated_B = world.max(static_cast<double>(requests.most_B - before_B));
            const double planned_B = plan.needs.memory_per_rank_B() - engines::program_B;
            INFO(fmt::format("{} ranks: planned {:.1f} MB, allocated {:.1f} MB", world.size(),
                             planned_B / 1e6, allocated_B / 1e6));
            CHECK(allocated_B == Approx(planned_B).epsilon(0.1));
        }
    }
}

} // namespace

TEST_CASE("a rank allocates the planned memory within 10 %", "[mpi]") {
    check_memory(false);
}

TEST_CASE("a rank allocates the planned memory of long cases within 10 %", "[mpi][long]") {
    check_memory(true);
}

} // namespace test_planned_memory
