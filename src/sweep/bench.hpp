#pragma once

#include "model/case.hpp"
#include "parallel/comm.hpp"
#include "sweep/commands.hpp"

#include <algorithm>
#include <chrono>

namespace shearwake {

/// What the benchmarks of the engines share. All collective.

/// The slowest rank's seconds.
double seconds_of(const Comm& world, const auto& work) {
    using Clock = std::chrono::steady_clock;
    world.barrier();
    const auto began = Clock::now();
    work();
    return world.max(std::chrono::duration<double>(Clock::now() - began).count());
}

/// Best of a few: what the machine can do when nobody else uses it.
double best_of(int times, const auto& measure) {
    double best = measure();
    for (int i = 1; i < times; ++i)
        best = std::min(best, measure());
    return best;
}

/// What all ranks together copy at once, read and written.
double copy_rate_B_s(const Comm& world);

/// What the engine layered is measured with: three layers of skin, a focus at 7 m/s.
Case layered_bench_case();

/// What a machine takes for computing, transposing and files, kept for `plan`: see machine.hpp.
ExitCode bench_machine(const Comm& world);
/// What cases cost beside their solves, and how long teams wait for each other, by two sweeps that
/// are run where the program is started: tiny cases, and some of mixed cost with both engines.
ExitCode bench_sweep(int tiny_cases, const Comm& world);

/// A layer with or without a body, where the time of a step goes, and its floors.
ExitCode bench_spectral(const BenchArguments& arguments, const Comm& world);
/// Steps of the pseudospectral scheme in either precision, with and without losses, and their
/// floor.
ExitCode bench_pstd(const BenchArguments& arguments, const Comm& world);
/// The nerve fibres of a hand under pins, and under a carrier.
ExitCode bench_neural(const Comm& world);

} // namespace shearwake
